"""How the law `maturing` makes masses, for people, with the certainty of its sources."""

from collections.abc import Sequence

from mimoc.body.density import density
from mimoc.body.figures import GeomFigures, Part
from mimoc.body.maturing.head import ADULT_SHARE, DECAY_MONTHS, NEWBORN_EXCESS
from mimoc.body.maturing.masses import NECK_SHARE
from mimoc.body.maturing.rules import AGE_KEY, LAW, LAW_KEY, REFERENCE, Rule
from mimoc.body.tree import Geom, Growth

HEAD_KEY = "measurements.head_circumference_cm"
HEAD_SHARES = (
    f"such that head and neck of the average child have {ADULT_SHARE:g} + {NEWBORN_EXCESS:g} exp(-age / "
    f"{DECAY_MONTHS:g} months) of its mass (D, between Jensen 1989 and the Q dummies of UN R129, S)"
)


def mass_rule(
    geom: Geom, figures: GeomFigures, part: Part, hands: str, growth: Growth, sources: Sequence[str]
) -> Rule | None:
    """Return the rule of a geom's mass, or None where it is the published law's: density x volume.

    Args:
        geom: The geom.
        figures: Its reference values.
        part: The body part it belongs to.
        hands: `mitten` or `five_finger`.
        growth: What the law made of the body.
        sources: Keys of the measurements that its size comes from.
    """
    kg_per_m3 = density(figures, hands)
    usual = f"{kg_per_m3:.6g} kg/m3 x volume of MIMo's solid with these measurements"
    if part.region == "trunk":
        text = f"{usual} x {growth.trunk_left:.6g}: by {LAW}, the trunk gives what head, neck and feet gain (D)"
        return Rule(text, (*sources, HEAD_KEY, AGE_KEY, LAW_KEY))
    if part.name == "head":
        share = NECK_SHARE if geom.name == "neck" else 1 - NECK_SHARE
        text = f"{share:g} x {growth.head_gain:.6g} x the head's mass by the published law, {HEAD_SHARES}"
        text = f"by {LAW}, {text}; the neck has {NECK_SHARE:g} of that (D)"
        return Rule(text, (HEAD_KEY, AGE_KEY, LAW_KEY))
    if part.lies:
        text = f"{kg_per_m3:.6g} kg/m3, the density of {REFERENCE}, x volume, which by {LAW} is larger than there (D)"
        return Rule(text, (f"geom.{geom.name}.size", LAW_KEY))
    return None
