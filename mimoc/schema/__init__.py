"""The spec language: what a user can say about an infant, as frozen data."""

from mimoc.schema.actuation import ActuationSpec
from mimoc.schema.body import BodySpec, IndividualSpec, PartSpec
from mimoc.schema.control import ControlSpec
from mimoc.schema.delays import DelaysSpec
from mimoc.schema.infant import InfantSpec, as_written, read_spec, to_data, validated
from mimoc.schema.scene import RoomSpec, SceneSpec, TexturesSpec, ToysSpec
from mimoc.schema.senses import (
    AcuitySpec,
    ProprioceptionSpec,
    SensesSpec,
    TouchSpec,
    VestibularSpec,
    VisionSpec,
)
from mimoc.schema.tasks import TaskSpec

__all__ = [
    "AcuitySpec",
    "ActuationSpec",
    "BodySpec",
    "ControlSpec",
    "DelaysSpec",
    "IndividualSpec",
    "InfantSpec",
    "PartSpec",
    "ProprioceptionSpec",
    "RoomSpec",
    "SceneSpec",
    "SensesSpec",
    "TaskSpec",
    "TexturesSpec",
    "TouchSpec",
    "ToysSpec",
    "VestibularSpec",
    "VisionSpec",
    "as_written",
    "read_spec",
    "to_data",
    "validated",
]
