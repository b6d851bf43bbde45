"""Motors that follow their commands at once, as MIMo's do."""

Settings = tuple[tuple[str, str], ...]

OF_ACTIVATIONS = ("actlimited", "dynprm")
"""Attributes that only mean something for actuators with an activation."""


def at_once(defaults: Settings) -> Settings:
    """Return what all motors share, without an activation.

    MIMo's muscle model computes an activation of its own, and commands the resulting torque to the motor in place of
    the muscle, whose torque must not be filtered a second time.
    """
    kept = (pair for pair in defaults if pair[0] not in OF_ACTIVATIONS)
    return tuple((name, "none" if name == "dyntype" else value) for name, value in kept)
