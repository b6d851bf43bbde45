"""How fast the activation of an infant's muscles, motors and servos follows the command."""

from mimoc.actuation.setup import Origin
from mimoc.body import BodyTree

MATURING_S = 0.06
"""Time constant of every actuator from birth to 24 months under `maturing`, in [s] (D).

No infant's muscle has been timed. Half-relaxation of the soleus takes 90 ms at 3 years and 40 ms at 10 (Lin, Brown &
Walsh 1994, S), contraction times are an adult's early (McComas, Sica & Petito 1973, S): one constant for both, longer
than an adult's.
"""
AT_ONCE = 0.0
"""Time constant of an actuator without an activation."""

Settings = tuple[tuple[str, str], ...]

TIME_CONSTANT = "actuator.dynprm"
"""Key of the time constant for `mimoc explain`."""


def activation(tree: BodyTree, published_s: float) -> Settings:
    """Return the attributes that all actuators of a body share for their activation.

    Args:
        tree: The body, whose law of development decides.
        published_s: Time constant under `published`, in [s]; `AT_ONCE` is none.
    """
    time_constant_s = MATURING_S if tree.development == "maturing" else published_s
    if time_constant_s == AT_ONCE:
        return (("dyntype", "none"),)
    return (("actlimited", "false"), ("dyntype", "filterexact"), ("dynprm", f"{time_constant_s}"))


def activation_origin(tree: BodyTree, published: str) -> dict[str, Origin]:
    """Return where the time constant of a body's actuators comes from, by key.

    Args:
        tree: The body.
        published: Where it comes from under `published`; empty if there is none.
    """
    maturing = "relaxation of the soleus at 3 years (Lin, Brown & Walsh 1994), derived for 0 to 24 months"
    rule = maturing if tree.development == "maturing" else published
    return {TIME_CONSTANT: Origin(rule, ("spec.development",), "s")} if rule else {}
