"""The spec language: the description of an infant that a user writes, as frozen data."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mimoc.actuation.spec import ActuationSpec
    from mimoc.delays.spec import DelaysSpec
    from mimoc.noise.spec import NoiseSpec
    from mimoc.scenes.room.spec import RoomSpec
    from mimoc.scenes.spec import SceneSpec, TexturesSpec
    from mimoc.schema.body import BodySpec, IndividualSpec, PartSpec
    from mimoc.schema.infant import InfantSpec, as_written, read_spec, to_data, validated
    from mimoc.schema.spec import ControlSpec
    from mimoc.senses.proprioception.spec import ProprioceptionSpec
    from mimoc.senses.spec import SensesSpec
    from mimoc.senses.touch.spec import TouchSpec
    from mimoc.senses.vestibular.spec import VestibularSpec
    from mimoc.senses.vision.spec import AcuitySpec, VisionSpec
    from mimoc.tasks.base import TaskSpec
    from mimoc.toys.spec import ToysSpec

_HOMES = {
    "AcuitySpec": "mimoc.senses.vision.spec",
    "ActuationSpec": "mimoc.actuation.spec",
    "BodySpec": "mimoc.schema.body",
    "ControlSpec": "mimoc.schema.spec",
    "DelaysSpec": "mimoc.delays.spec",
    "IndividualSpec": "mimoc.schema.body",
    "InfantSpec": "mimoc.schema.infant",
    "NoiseSpec": "mimoc.noise.spec",
    "PartSpec": "mimoc.schema.body",
    "ProprioceptionSpec": "mimoc.senses.proprioception.spec",
    "RoomSpec": "mimoc.scenes.room.spec",
    "SceneSpec": "mimoc.scenes.spec",
    "SensesSpec": "mimoc.senses.spec",
    "TaskSpec": "mimoc.tasks.base",
    "TexturesSpec": "mimoc.scenes.spec",
    "TouchSpec": "mimoc.senses.touch.spec",
    "ToysSpec": "mimoc.toys.spec",
    "VestibularSpec": "mimoc.senses.vestibular.spec",
    "VisionSpec": "mimoc.senses.vision.spec",
    "as_written": "mimoc.schema.infant",
    "read_spec": "mimoc.schema.infant",
    "to_data": "mimoc.schema.infant",
    "validated": "mimoc.schema.infant",
}
"""Module of each name, imported when the name is first used, because the kinds import this package."""

__all__ = [
    "AcuitySpec",
    "ActuationSpec",
    "BodySpec",
    "ControlSpec",
    "DelaysSpec",
    "IndividualSpec",
    "InfantSpec",
    "NoiseSpec",
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


def __getattr__(name: str) -> Any:
    """Import a name from its home."""
    if name not in _HOMES:
        raise AttributeError(f"module 'mimoc.schema' has no attribute '{name}'")
    return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    """Return all names, also those not imported yet."""
    return __all__
