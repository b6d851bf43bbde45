"""What each number of MuJoCo's parameter arrays means; nothing else in mimoc knows their order."""

from typing import NamedTuple

TIME_CONSTANT = 0  # Column of `actuator_dynprm` with the time constant of an activation, in [s].

LOCK_ANGLE = 0
"""Column of `eq_data` with the angle that a joint equality keeps a hinge at, beyond its `qpos0`, in [rad]."""

WELD_ANCHOR, WELD_PLACE, WELD_TURN = slice(0, 3), slice(3, 6), slice(6, 10)
"""Columns of `eq_data` of a weld to the world: its point in the frame of the body, and that point's place and the
body's quaternion in the world."""


LAST_VISIBLE_GROUP = 2  # MuJoCo draws geoms up to this group unless asked otherwise.

BODY_GROUP = 0  # Group of an infant's solids where no skin is drawn over them, and of eyeballs.

SOLIDS_GROUP = 5
"""Group of an infant's solids where a skin is drawn over them: one that MuJoCo does not draw unless asked to, and that
has nothing else in it, unlike group 3 with the shapes that toys collide with."""


class MuscleParameters(NamedTuple):
    """Gain and bias parameters of MuJoCo's muscles, which are the same numbers."""

    shortest: float  # Length at the end of the range where it is shortest, in optimal lengths.
    longest: float  # Length at the other end.
    force: float  # Largest isometric force; about a hinge with a gear of 1, a torque in [N m].
    scale: float  # What MuJoCo scales forces by that are not given.
    least_active: float  # Length below which it is not active, in optimal lengths.
    most_active: float  # Length above which it is not active.
    vmax: float  # Speed of shortening at which it does not pull, in optimal lengths a second.
    passive: float  # Largest force of the stretched muscle at rest, by the isometric one.
    lengthening: float  # Largest force of the active muscle that is being lengthened, by the isometric one.


class AffineBias(NamedTuple):
    """Bias parameters of an actuator whose force follows length and velocity, as a servo's does."""

    at_zero: float  # Force at length 0 and at rest.
    by_length: float  # Change of force by length.
    by_velocity: float  # Change of force by velocity.


MUSCLE_FORCE = MuscleParameters._fields.index("force")
"""Column of `actuator_gainprm` with the largest isometric force of a muscle."""
