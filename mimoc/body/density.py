"""Density: what each geom of MIMo's body weighs by its volume there, which is the same at every age.

Sizes follow the measurements of children, and so do volumes; masses are density x volume, so that no part is made of
anything but what MIMo's is made of, however much its size differs from MIMo's. A body of 18 months therefore weighs not
exactly what MIMo's does: 11.2 kg in place of 10.9 kg, since our thighs, shanks and heads are larger than MIMo's by what
AnthroKids' children measure. Sizes in here are MIMo's (Mattern et al. 2024; López et al. 2025);
`{side}` stands for right and left.
"""

from collections.abc import Mapping

from mimoc.body.figures import GeomFigures
from mimoc.body.mass import volume

Size = tuple[float, ...]
"""As MuJoCo wants it, in [m]."""


def density(figures: GeomFigures, hands: str) -> float:
    """Return the density of a geom, in kg/m³; 0 for fillers without mass.

    Args:
        figures: Of the geom.
        hands: `mitten` or `five_finger`: hands and feet of MIMo's two bodies differ.
    """
    if not figures.mass_kg:
        return 0.0
    return figures.mass_kg / volume(figures.type, {**SIZES, **EXTREMITIES[hands]}[figures.name])


SIZES: Mapping[str, Size] = {
    "lb": (0.048, 0.043),
    "cb": (0.053, 0.035),
    "ub1": (0.052, 0.035),
    "ub2": (0.048, 0.039),
    "ub3": (0.041, 0.047),
    "{side}_uarm1": (0.024, 0.0536),
    "{side}_larm": (0.023, 0.037),
    "head": (0.0735,),
    "{side}_eye1": (0.01125,),
    "{side}_upper_leg1": (0.037, 0.0625),
    "{side}_lower_leg1": (0.029, 0.044),
    "{side}_lower_leg2": (0.021, 0.028),
}
"""What both of MIMo's bodies have in common."""

EXTREMITIES: Mapping[str, Mapping[str, Size]] = {
    "mitten": {
        "{side}_hand1": (0.0281, 0.01, 0.0208),
        "{side}_hand2": (0.0102, 0.0278),
        "{side}_fingers1": (0.0228, 0.01, 0.0207),
        "{side}_fingers2": (0.0102, 0.023),
        "{side}_foot1": (0.0249, 0.0099),
        "{side}_foot2": (0.035, 0.025, 0.01),
        "{side}_foot3": (0.0099, 0.0248),
        "{side}_toes1": (0.007, 0.0249, 0.0099),
        "{side}_toes2": (0.01, 0.025),
    },
    "five_finger": {
        "{side}_hand1": (0.01712, 0.00584, 0.02532),
        "{side}_hand2": (0.00588, 0.00584, 0.01292),
        "{side}_hand3": (0.00584, 0.0171),
        "{side}_hand4": (0.00584, 0.02298),
        "{side}_ffknuckle1": (0.00549, 0.00992),
        "{side}_ffmiddle1": (0.0052, 0.00501),
        "{side}_ffdistal1": (0.005, 0.00464),
        "{side}_mfknuckle1": (0.00579, 0.011),
        "{side}_mfmiddle1": (0.0054, 0.00562),
        "{side}_mfdistal1": (0.0052, 0.00538),
        "{side}_rfknuckle1": (0.00549, 0.00978),
        "{side}_rfmiddle1": (0.0052, 0.00489),
        "{side}_rfdistal1": (0.005, 0.00479),
        "{side}_lfmetacarpal1": (0.00508, 0.00584, 0.01292),
        "{side}_lfmetacarpal2": (0.00584, 0.005),
        "{side}_lfknuckle1": (0.00529, 0.00816),
        "{side}_lfmiddle1": (0.005, 0.00455),
        "{side}_lfdistal1": (0.0049, 0.00391),
        "{side}_thbase1": (0.00736, 0.01027),
        "{side}_thhub1": (0.00638, 0.00697),
        "{side}_thdistal1": (0.00618, 0.00587),
        "{side}_foot1": (0.0249, 0.0101),
        "{side}_foot2": (0.03, 0.025, 0.01),
        "{side}_foot3": (0.0101, 0.0251),
        "{side}_big_toe1": (0.0095, 0.007, 0.0099),
        "{side}_big_toe2": (0.01, 0.0075),
        "{side}_toes1": (0.0095, 0.016, 0.0099),
        "{side}_toes2": (0.01, 0.0165),
    },
}
"""Hands and feet, by the kind of hands."""
