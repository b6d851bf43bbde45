"""What an actuation model makes of a body."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from mimoc.actuation import ACTUATIONS
from mimoc.actuation.spec import ActuationSpec
from mimoc.body import BodyTree, Joint
from mimoc.kinds import function_of
from mimoc.mjcf.infant import Actuator
from mimoc.mjcf.scene import Keyframe


def unchanged(keyframe: Keyframe) -> Keyframe:
    """Return a state as it is: actuators at rest have no state of their own in it."""
    return keyframe


@dataclass(frozen=True, slots=True)
class Origin:
    """Where a number comes from."""

    rule: str
    """How it is computed, and from which publication."""
    sources: tuple[str, ...] = ()
    """The numbers that it is computed from, by their keys for `mimoc explain`."""
    unit: str = ""
    """Its unit; empty where it has none, or is several numbers with different units."""


@dataclass(frozen=True, slots=True)
class ActuationSetup:
    """The actuators of an infant, and its joints with the springs and dampers that the actuators leave them."""

    actuators: tuple[Actuator, ...]
    """In the order of the model."""
    defaults: tuple[tuple[str, str], ...]
    """The attributes that all actuators have in common."""
    integrator: str
    """MuJoCo's integrator: where actuators damp, one that is implicit in their damping."""
    joints: Mapping[str, Joint]
    """The hinges, by name, with the springs and dampers that are left to them."""
    at_rest: Callable[[Keyframe], Keyframe] = unchanged
    """Returns a state with the actuators at rest."""
    origins: Mapping[str, Origin] = field(default_factory=dict)
    """Where numbers come from, by key: `actuator.NAME.ATTRIBUTE` for a setting of an actuator, `joint.NAME.stiffness`
    and `joint.NAME.damping` for what is changed of a joint. Others are put down to the actuation model as such."""


def build_actuation(spec: ActuationSpec, tree: BodyTree, timestep_s: float) -> ActuationSetup:
    """Return what the actuation model of a spec makes of a body."""
    kind = ACTUATIONS[spec.model]
    own = getattr(spec, kind.name) if kind.spec else None
    return function_of(kind.build, "build")(own, tree, timestep_s)
