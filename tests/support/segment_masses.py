"""Masses of the segments of a body, next to published ones and to those by the growth law of MIMo's paper."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import cast

from mimoc.anatomy.anatomy import Anatomy, assemble
from mimoc.anatomy.part import Region
from mimoc.base.units import m_to_cm
from mimoc.body.grow import grow_average
from mimoc.body.reference import reference_body
from mimoc.body.shapes import shape_parts
from mimoc.body.tree import BodyTree
from mimoc.fits import Measurements, measure

HEAD, TORSO, ARMS, LEGS = "head and neck", "torso", "both arms", "both legs"
THIGH, SHANK, FOOT = "thigh", "shank", "foot"
WEEKS_PER_MONTH = 365.25 / 12 / 7

DUMMIES: Mapping[float, Mapping[str, float]] = {
    0.0: {HEAD: 0.326, TORSO: 0.403, ARMS: 0.081, LEGS: 0.167},
    12.0: {HEAD: 0.251, TORSO: 0.439, ARMS: 0.093, LEGS: 0.190},
    18.0: {HEAD: 0.252, TORSO: 0.427, ARMS: 0.108, LEGS: 0.186},
}
"""Shares of the whole mass, suit included, of the crash test dummies Q0, Q1 and Q1.5, by age in months (UN R129, table
of component masses; S)."""


@dataclass(frozen=True, slots=True)
class Regression:
    """A published formula for a segment's mass in kg."""

    source: str  # Publication, with what is known of it: S read in the source, M from memory.
    segment: str
    mass_kg: Callable[[Measurements, float], float]  # From the measurements of a child and its mass in kg.


def _by_weeks(newborn_kg: float, kg_per_week: float) -> Callable[[Measurements, float], float]:
    return lambda child, _: newborn_kg + kg_per_week * child.age_months * WEEKS_PER_MONTH


def _jensen(child: Measurements, mass_kg: float) -> float:
    years = child.age_months / 12
    return mass_kg * (0.27881 - 0.021152 * years + 0.00053168 * years**2)


def _schneider(child: Measurements, mass_kg: float) -> float:
    length_cm, breadth_cm = m_to_cm(child["foot_length"]), m_to_cm(child["foot_breadth"])
    return 0.0029 * mass_kg + 1.24 * length_cm / 100 + 1.93 * breadth_cm / 100 - 0.1025


SUN = "Sun & Jensen 1994 (M)"
REGRESSIONS = (
    Regression("Jensen 1989 (S; fitted at 4 to 20 years)", HEAD, _jensen),
    Regression(SUN, THIGH, _by_weeks(0.239, 0.0124)),
    Regression(SUN, SHANK, _by_weeks(0.169, 0.00416)),
    Regression(SUN, FOOT, _by_weeks(0.0522, 0.00212)),
    Regression("Schneider & Zernicke 1992 (M)", FOOT, _schneider),
)


def segment_masses(tree: BodyTree) -> dict[str, float]:
    """Return the mass of each segment of a body in kg; thigh, shank and foot are those of the left leg."""
    bodies = {body.name: body.mass_kg for body in tree.bodies}
    leg = ("upper_leg", "lower_leg", "foot", "toe")
    trunk = {body.name for body in tree.bodies if body.region == "trunk"}

    def total(of: Callable[[str], bool]) -> float:
        return math.fsum(mass_kg for name, mass_kg in bodies.items() if of(name))

    def is_of(name: str, parts: Sequence[str]) -> bool:
        return any(part in name for part in parts)

    return {
        HEAD: total(lambda name: is_of(name, ("head", "_eye"))),
        TORSO: total(lambda name: name in trunk),
        ARMS: total(lambda name: name not in trunk and not is_of(name, (*leg, "head", "_eye"))),
        LEGS: total(lambda name: is_of(name, leg)),
        THIGH: bodies["left_upper_leg"],
        SHANK: bodies["left_lower_leg"],
        FOOT: total(lambda name: name.startswith("left_") and is_of(name, ("foot", "toe"))),
    }


def shares_table() -> str:
    """Return the segments' shares of the whole mass by both laws and of dummies, as Markdown."""
    jensen = REGRESSIONS[0]
    lines = ["| months | segment | maturing | published | Q dummy (S) | Jensen 1989 (S, extrapolated) |"]
    lines.append("|" + "---|" * 6)
    for age_months, dummy in DUMMIES.items():
        child, grown, published, mass_kg = _average(age_months)
        for segment, share in dummy.items():
            other = f"{jensen.mass_kg(child, mass_kg) / mass_kg:.3f}" if segment == jensen.segment else ""
            shares = (grown[segment] / mass_kg, published[segment] / mass_kg, share)
            cells = (f"{age_months:g}", segment, *(f"{part:.3f}" for part in shares), other)
            lines.append(f"| {' | '.join(cells)} |")
    return "\n".join(lines)


def legs_table(ages_months: Sequence[float] = (0, 3, 6, 12, 18, 24)) -> str:
    """Return the masses of thigh, shank and foot in kg by both laws and by regressions, as Markdown."""
    lines = ["| months | segment | maturing | published | Sun & Jensen 1994 (M) | Schneider & Zernicke 1992 (M) |"]
    lines.append("|" + "---|" * 6)
    for age_months in ages_months:
        child, grown, published, mass_kg = _average(age_months)
        for segment in (THIGH, SHANK, FOOT):
            others = [
                f"{regression.mass_kg(child, mass_kg):.3f}"
                for regression in REGRESSIONS
                if regression.segment == segment
            ]
            cells = (f"{age_months:g}", segment, f"{grown[segment]:.3f}", f"{published[segment]:.3f}", *others)
            lines.append(f"| {' | '.join((*cells, *[''] * (2 - len(others))))} |")
    return "\n".join(lines)


def _average(age_months: float) -> tuple[Measurements, dict[str, float], dict[str, float], float]:
    """Return measurements, masses of the segments by both laws, and the mass of the average child of an age."""
    grown = grow_average(age_months, assemble("mitten", False))
    published = grow_average(age_months, assemble("mitten", False, "published"))
    return measure(age_months), segment_masses(grown), segment_masses(published), grown.mass_kg


@dataclass(frozen=True)
class ByVolume:
    """Masses and torques of a child in proportion to the volumes of MIMo's solids with its measurements."""

    masses_kg: dict[str, float]  # By body.
    gears_nm: dict[str, float]  # By motor.
    regions: dict[str, Region]  # By body.


def by_volume(child: Measurements, anatomy: Anatomy) -> ByVolume:
    reference = reference_body(anatomy, child.age_months)
    volumes_m3 = shape_parts(child, reference).mimos_m3
    masses_kg = {
        part.name.format(side=side): sum(
            reference.densities_kg_m3[geom.name] * volumes_m3[side][geom.name] for geom in part.geoms
        )
        for side, part in anatomy.mimos_parts
    }
    gears_nm = {
        motor.name.format(side=side): motor.gear_nm
        * cast(float, volumes_m3[side][motor.driven_geom] / reference.volumes_m3[motor.driven_geom])
        for side, motor in anatomy.motors
    }
    return ByVolume(
        masses_kg, gears_nm, {part.name.format(side=side): part.region for side, part in anatomy.mimos_parts}
    )
