"""The spec language: the description of an infant that a user writes, as frozen data."""

from typing import TYPE_CHECKING

from mimoc.base.lazy import names_of

if TYPE_CHECKING:
    from mimoc.schema.actuation import ActuationSpec as ActuationSpec
    from mimoc.schema.body import (
        BodySpec as BodySpec,
        IndividualSpec as IndividualSpec,
        LooksSpec as LooksSpec,
        PartSpec as PartSpec,
    )
    from mimoc.schema.caregiver import AnswersSpec as AnswersSpec, CaregiverSpec as CaregiverSpec
    from mimoc.schema.impairments import ImpairmentsSpec as ImpairmentsSpec, ToneSpec as ToneSpec
    from mimoc.schema.infant import (
        ControlSpec as ControlSpec,
        InfantSpec as InfantSpec,
        as_written as as_written,
        read_spec as read_spec,
        to_data as to_data,
        validated as validated,
    )
    from mimoc.schema.objects import ToysSpec as ToysSpec
    from mimoc.schema.scene import SceneSpec as SceneSpec, TexturesSpec as TexturesSpec
    from mimoc.schema.senses import DelaysSpec as DelaysSpec, NoiseSpec as NoiseSpec, SensesSpec as SensesSpec
    from mimoc.schema.task import TaskSpec as TaskSpec

__getattr__, __dir__, __all__ = names_of(__name__)
