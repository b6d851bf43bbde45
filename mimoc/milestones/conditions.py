"""Under what conditions an infant attempts a trial."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Conditions:
    """What can be varied to see how much a result hangs on it."""

    push: float = 0.03
    """Size of the pushes while sitting and standing, in body weights."""
    servo: float = 1.0
    """Factor on the natural frequency of the controller."""
    strength: float = 1.0
    """Factor on the torque limits of all motors, on top of the infant's own."""
    delays: bool = False
    """Whether the infant's own delays of senses and commands apply, with a forward model that predicts over them."""
