"""What an actuation model makes of a body."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from mimoc.actuation import ACTUATIONS
from mimoc.actuation.spec import ActuationSpec
from mimoc.body import BodyTree, Joint
from mimoc.kinds import function_of
from mimoc.mjcf.tree import Actuator, Keyframe


def unchanged(keyframe: Keyframe) -> Keyframe:
    """Return a state as it is: actuators at rest have no state of their own in it."""
    return keyframe


@dataclass(frozen=True, slots=True)
class Drive:
    """The actuators of an infant, and its joints as they leave them."""

    actuators: tuple[Actuator, ...]
    """In the order of the model."""
    defaults: tuple[tuple[str, str], ...]
    """The attributes that all its actuators have in common."""
    integrator: str
    """MuJoCo's: where actuators damp, one that is implicit in their damping."""
    joints: Mapping[str, Joint]
    """The hinges, by name, with the springs and dampers that it leaves them."""
    keyframe: Callable[[Keyframe], Keyframe] = unchanged
    """Returns a state with the actuators at rest."""


def build_drive(spec: ActuationSpec, tree: BodyTree, timestep_s: float) -> Drive:
    """Return what the actuation model of a spec makes of a body."""
    kind = ACTUATIONS[spec.model]
    own = getattr(spec, kind.name) if kind.spec else None
    return function_of(kind.build, "build")(own, tree, timestep_s)
