"""All that the author of a plug-in needs, in one place: `from mimoc.plugin import Entry, SenseKind, Spec, Term`.

`dir(mimoc.plugin)` are the names. Each is imported from its home when it is first asked for, so that a record stays as
light as its own modules.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mimoc.actuation.binding import Actuation as Actuation
    from mimoc.actuation.binding import effort_of as effort_of
    from mimoc.base.kinds import ActuationKind as ActuationKind
    from mimoc.base.kinds import AgeTable as AgeTable
    from mimoc.base.kinds import NoiseOption as NoiseOption
    from mimoc.base.kinds import PartKind as PartKind
    from mimoc.base.kinds import PolicyKind as PolicyKind
    from mimoc.base.kinds import SceneKind as SceneKind
    from mimoc.base.kinds import SenseKind as SenseKind
    from mimoc.base.kinds import TaskKind as TaskKind
    from mimoc.base.kinds import ToySource as ToySource
    from mimoc.body.part import ReferenceGeom as ReferenceGeom
    from mimoc.body.part import ReferenceJoint as ReferenceJoint
    from mimoc.body.part import ReferenceMotor as ReferenceMotor
    from mimoc.body.part import ReferencePart as ReferencePart
    from mimoc.mjcf.scene import Placed as Placed
    from mimoc.noise.noise import LowPass as LowPass
    from mimoc.noise.noise import Noise as Noise
    from mimoc.noise.noise import Smooth as Smooth
    from mimoc.plugins import register as register
    from mimoc.quantities import Quantity as Quantity
    from mimoc.runtime.term import Concatenated as Concatenated
    from mimoc.runtime.term import Field as Field
    from mimoc.runtime.term import Term as Term
    from mimoc.runtime.term_contract import check_term as check_term
    from mimoc.runtime.worlds import Worlds as Worlds
    from mimoc.senses.custom import TermSense as TermSense
    from mimoc.senses.sense import Sense as Sense
    from mimoc.senses.sense import Vector as Vector
    from mimoc.tasks.base import TaskEntry as TaskEntry
    from mimoc.tasks.base import TaskSpec as TaskSpec
    from mimoc.tasks.setup import TaskSetup as TaskSetup
    from mimoc.tasks.task import Change as Change
    from mimoc.tasks.task import Judgement as Judgement
    from mimoc.tasks.task import Task as Task
    from mimoc.tasks.task import Verdict as Verdict

_NAMES = {
    "mimoc.actuation.binding": "Actuation effort_of",
    "mimoc.body.dimensions": "BodyGeometry GeomShape",
    "mimoc.body.part": "ReferenceGeom ReferenceJoint ReferenceMotor ReferencePart",
    "mimoc.base.kinds": "ActuationKind AgeTable NoiseOption PartKind PolicyKind SceneKind SenseKind TaskKind ToySource",
    "mimoc.mjcf.scene": "Placed",
    "mimoc.noise.noise": "LowPass Noise Smooth",
    "mimoc.plugins": "register",
    "mimoc.quantities": "Quantity",
    "mimoc.runtime.term": "Concatenated Field Term",
    "mimoc.runtime.term_contract": "check_term",
    "mimoc.runtime.worlds": "Worlds",
    "mimoc.schema.base": "Model",
    "mimoc.senses.sense": "Sense Vector",
    "mimoc.senses.custom": "TermSense",
    "mimoc.tasks.base": "TaskEntry TaskSpec",
    "mimoc.tasks.setup": "TaskSetup",
    "mimoc.tasks.task": "Change Judgement Task Verdict",
}
"""The names of each home; `Model` is what a spec and an entry are made of."""
_HOMES = {name: home for home, names in _NAMES.items() for name in names.split()}
_MODELS = ("Entry", "Spec")


def __getattr__(name: str) -> Any:
    """Import a name from its home."""
    original = "Model" if name in _MODELS else name
    if original not in _HOMES:
        raise AttributeError(f"module 'mimoc.plugin' has no attribute '{name}'")
    return getattr(import_module(_HOMES[original]), original)


def __dir__() -> list[str]:
    """Return all names, also those not imported yet."""
    return sorted({*_HOMES, *_MODELS} - {"Model"})
