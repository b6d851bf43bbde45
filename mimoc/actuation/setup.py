"""The actuators that an actuation model adds to a body, and its changes to joints."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

from mimoc.actuation import ACTUATIONS
from mimoc.actuation.spec import ActuationSpec
from mimoc.body import BodyTree, Joint
from mimoc.body.origins import Origin as Origin
from mimoc.kinds import function_of
from mimoc.mjcf.infant import Actuator
from mimoc.mjcf.scene import Keyframe


def unchanged(keyframe: Keyframe) -> Keyframe:
    """Return a keyframe unchanged, for actuators that need no values in it."""
    return keyframe


@dataclass(frozen=True, slots=True)
class ActuationSetup:
    """The actuators of an infant, and its joints with the stiffness and damping that remain beside the actuators."""

    actuators: tuple[Actuator, ...]
    """The actuators, in the order of the model."""
    defaults: tuple[tuple[str, str], ...]
    """Attributes that all actuators share."""
    integrator: str
    """MuJoCo's integrator: implicit in velocity if the actuators have damping."""
    joints: Mapping[str, Joint]
    """The hinges by name, with the stiffness and damping that remain beside the actuators."""
    at_rest: Callable[[Keyframe], Keyframe] = unchanged
    """Returns a state with the actuators at rest."""
    origins: Mapping[str, Origin] = field(default_factory=dict)
    """Where numbers come from, by key: `actuator.NAME.ATTRIBUTE` for a setting of an actuator, `joint.NAME.stiffness`
    and `joint.NAME.damping` for what is changed of a joint. Others are put down to the actuation model as such."""


def build_actuation(spec: ActuationSpec, tree: BodyTree, timestep_s: float) -> ActuationSetup:
    """Return what the actuation model of a spec makes of a body."""
    kind = ACTUATIONS[spec.model]
    section = getattr(spec, kind.name) if kind.spec else None
    return function_of(kind.build, "build")(section, tree, timestep_s)
