"""How infants of the same age differ in their spontaneous movement."""

from dataclasses import dataclass, fields


@dataclass(frozen=True, slots=True)
class Styles:
    """Standard deviations over infants; those without another unit are of the logarithm of a number of `Law`.

    Fitted, with muscles at 3 months, to the standard deviations of the measures of 12 real infants (MINI-RGBD).
    """

    rate: float = 0.25
    strength: float = 0.12
    duration: float = 0.17
    swell: float = 0.25
    slow: float = 0.2
    tone: float = 0.2
    arms: float = 0.2
    side: float = 0.08
    """Of the rate of the left limbs over that of the right ones, halved."""
    posture: float = 0.12
    """Of the lasting share of each joint; not of a logarithm."""
    limbs: float = 0.1
    """Of the lasting flexion of each limb, a share; not of a logarithm."""


STYLES = Styles()
TRAITS = tuple(field.name for field in fields(Styles) if field.name not in ("posture", "limbs"))
"""What a single number of an infant says; its lasting posture has one for each joint and each limb."""
