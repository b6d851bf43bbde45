"""Where the numbers of servos come from."""

from collections.abc import Iterator

from mimoc.actuation.muscle.build import LONGEST, SHORTEST
from mimoc.actuation.setup import Origin
from mimoc.body import BodyTree, Motor
from mimoc.body.origins import LAW, REFERENCE
from mimoc.body.strength import FORWARDS

LAG_S = 0.03
"""Time constant with which the target follows the command, and least time by which the joint is behind the target; both
smooth what is commanded."""
STEPS_OF_LAG = 2
"""The least number of physics steps by which a joint is behind its target."""
FINEST_STEP_S = 0.005
"""Shorter physics steps make no stiffer servos."""

MODEL_KEY, STEP_KEY = "spec.actuation.model", "spec.control.timestep_ms"
_DAMPING = (
    f"peak torque / speed at which its muscles do not pull (vmax ({REFERENCE}) x range / {LONGEST - SHORTEST:.2f}), "
    "where that is more than the joint has with torque motors"
)
_STOP = f"least inertia about the joint / physics step (of {1000 * FINEST_STEP_S:g} ms at least)"
_STIFFNESS = f"({_STOP} + damping of the joint) / lag ({LAG_S:g} s, and {STEPS_OF_LAG} physics steps at least)"


def servo_origins(tree: BodyTree) -> Iterator[tuple[str, Origin]]:
    """Yield where each number of the servos comes from, and of the joints' dampers, by key."""
    for joint in tree.joints:
        gears = (f"actuator.{motor.name}.gear" for motor in tree.motors if motor.joint == joint)
        yield f"joint.{joint}.damping", Origin(_DAMPING, (MODEL_KEY, *gears, f"joint.{joint}.range"))
    for motor in tree.motors:
        low, high = motor.force_range
        at, gains = f"actuator.{motor.name}", _sources(tree, motor)
        limits = (
            f"gear x part of it that is reached towards negative and positive angles: {low:.6g} and {high:.6g} "
            f"({REFERENCE}{_matured(tree, motor)})"
        )
        bias = f"torque at angle 0, then by angle: -{_STIFFNESS}, less the joint's own spring, and by speed: -{_STOP}"
        yield f"{at}.forcerange", Origin(limits, (f"{at}.gear",), "N m")
        yield f"{at}.gainprm", Origin(f"{_STIFFNESS} x half of the joint's range", gains)
        yield f"{at}.biasprm", Origin(bias, gains)


def _matured(tree: BodyTree, motor: Motor) -> str:
    """Return what is said of a motor whose two directions mature apart."""
    if tree.growth is None or motor.name not in FORWARDS:
        return ""
    return f", towards positive angles x strength of its front by that of its back at this age by {LAW}; D"


def _sources(tree: BodyTree, motor: Motor) -> tuple[str, ...]:
    """Return the keys of what a servo's stiffness and damping follow."""
    constants = (f"joint.{motor.joint}.{name}" for name in ("range", "stiffness", "springref", "damping", "armature"))
    return (*constants, STEP_KEY, *(f"body.{body}.mass" for body in _moved(tree, motor.joint)))


def _moved(tree: BodyTree, joint: str) -> list[str]:
    """Return the bodies that a joint moves."""
    moved: list[str] = []
    for body in tree.bodies:
        if body.parent in moved or joint in [hinge.name for hinge in body.joints]:
            moved.append(body.name)
    return moved
