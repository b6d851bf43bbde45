"""What the strength and the joints of a child mature with: age, its length, and the volumes of its parts.

An individual child's strength differs from that of its size and age by how lean it is and how fast it matures.

Only the lean part of a body is strong. With the share F of fat in the weight, and F_0 that of the average child of the
same age, the strength of each part but the neck is that of its volume times

    (1 - F) / (1 - F_0)

Where the spec does not give the fat, it follows from length and weight: F = F_0 b, with the volume b of trunk and limbs
relative to a child of the same length with the average child's proportions (D). So .83 of the weight that a newborn has
above what its length asks for is free of fat, and .48 at 6 months. Perng et al. 2017 (Am J Clin Nutr 106: 559, S) find
.34 of .46 kg for each SD of newborns' weight, and that at 5 months weight for length goes with fat more than with lean.

A child born early has 3 % more fat at term, and no more from 3 months on (`mimoc.fits.standards`).

A child of rate k is as mature at age t as the average child at k t: strength beyond what size explains, muscle tone,
ranges of joints, fists and grasp. Size, proportions, delays, noise and acuity follow the age itself (D).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from statistics import NormalDist

from mimoc.anatomy.anatomy import Anatomy
from mimoc.anatomy.part import REFERENCE_AGE_MONTHS
from mimoc.anatomy.parts.trunk import TENDONS
from mimoc.body.origins import Origin
from mimoc.body.reference import HEIGHT, Reference
from mimoc.body.shapes import Shapes
from mimoc.body.tree import MaturationFactors
from mimoc.fits import Measurements
from mimoc.fits.standards import fat_percent, mean_fat_percent, more_fat_percent
from mimoc.schema.body import FAT, IndividualSpec
from mimoc.schema.infant import InfantSpec

SIZES = ("length_percentile", "length_cm", "weight_percentile", "weight_kg")
"""Keys of an individual that its build follows from."""
RATE_KEY = "spec.body.individual.maturation_rate"


@dataclass(frozen=True, slots=True)
class Composition:
    """What an individual child's strength follows, besides age and size; by default, the average child's."""

    maturation_rate: float = 1.0
    lean_gain: float = 1.0  # Lean share of the body, relative to the average child of the same age.
    lean_keys: tuple[str, ...] = ()  # Keys of the spec that it follows from, unless it is 1.

    def of_size(self) -> "Composition":
        """Return that of a child that matures at the same rate, and is as lean as the average child."""
        return Composition(self.maturation_rate)


AVERAGE = Composition()


def composition(child: Measurements, spec: InfantSpec) -> Composition:
    """Return the composition of a spec's child that has been measured."""
    individual = spec.body.individual or IndividualSpec.model_construct()
    early = spec.birth_keys
    if spec.body.individual is None and not early:
        return AVERAGE
    usual = mean_fat_percent(child.age_months)
    percent = _fat_percent(child, individual, spec.months_early)
    gain = 1.0 if percent == usual else (100 - percent) / (100 - usual)
    given = [key for key in FAT if getattr(individual, key) is not None]
    sizes = [key for key in SIZES if getattr(individual, key)]
    keys = *(f"spec.body.individual.{key}" for key in given or sizes), *(() if given else early)
    return Composition(individual.maturation_rate or 1.0, gain, keys if gain != 1 else ())


def _fat_percent(child: Measurements, individual: IndividualSpec, months_early: float) -> float:
    if individual.fat_percent is not None:
        return individual.fat_percent
    if individual.fat_percentile is not None:
        return fat_percent(NormalDist().inv_cdf(individual.fat_percentile / 100), child.age_months)
    more = more_fat_percent(months_early, child.age_months)
    build = child.slenderness**2 if any(getattr(individual, key) is not None for key in SIZES) else 1.0
    return (mean_fat_percent(child.age_months) + more) / build


NECK = "neck"
"""The group whose load is the head, which is heavier by the law `maturing`: its strength and joints grow with it."""
EYES, HAND = "eyes", "hand"  # Groups of their own.
FISTS = tuple(
    f"robot:{{side}}_{finger}_{joint}"
    for finger in ("ff", "mf", "rf", "lf")
    for joint in ("knuckle", "middle", "distal")
)
"""Joints that close five fingers to a fist."""
FINGERS = frozenset({"robot:{side}_fingers", *FISTS})
RelativeVolumes = Mapping[str, Mapping[str, float]]
"""Volumes v relative to the average child of 18 months, by side, then by geom with `{side}`."""


@dataclass(frozen=True, slots=True)
class Decay:
    """What is particular to newborns, and is gone at 18 months: a stretched exponential of age.

    The newborn share is (e(t) - e(18)) / (1 - e(18)) with e(t) = exp(-(t / tau)^power) and t the age in months: 1 at
    birth, 0 from 18 months on.
    """

    tau_months: float  # Time constant: the older the infant when it is lost, the longer.
    power: float  # Steepness: 1 is a plain exponential, above 1 the loss begins slowly.

    def __call__(self, age_months: float) -> float:
        """Return the newborn share, from 1 at birth to 0 at 18 months and later."""
        if age_months >= REFERENCE_AGE_MONTHS:
            return 0.0
        last = math.exp(-((REFERENCE_AGE_MONTHS / self.tau_months) ** self.power))
        return (math.exp(-((age_months / self.tau_months) ** self.power)) - last) / (1 - last)


def relative_volumes(shapes: Shapes, reference: Reference) -> RelativeVolumes:
    """Return the volume v of each geom by the growth law of the paper, relative to 18 months."""
    at_18 = reference.volumes_m3
    return shapes.of_sides(lambda side: {name: v / at_18[name] for name, v in shapes.mimos_m3[side].items()})


def _volumes_of_joints(volumes: RelativeVolumes, anatomy: Anatomy) -> dict[str, float]:
    """Return the volume v that each joint's strength follows, by joint.

    A joint without a motor has that of the joint that a tendon couples it to, as the second vertebra's joints, or else
    of the part that it moves.
    """
    by_joint = {figures.joint.format(side=side): volumes[side][figures.driven_geom] for side, figures in anatomy.motors}
    for _, _, ((first, _), (second, _)) in TENDONS:
        by_joint.setdefault(second, by_joint[first])
    for side, part in anatomy.parts:
        for joint in part.joints:
            by_joint.setdefault(joint.name.format(side=side), volumes[side][part.geoms[0].name])
    return by_joint


def maturation(
    child: Measurements, volumes: RelativeVolumes, head_gain: float, reference: Reference, composed: Composition
) -> MaturationFactors | None:
    """Return what strength and joints mature with besides age; None by the published law, by which nothing does."""
    if reference.anatomy.development == "published":
        return None
    length = child.paper_law[HEIGHT] / reference.length_m
    return MaturationFactors(
        length,
        _volumes_of_joints(volumes, reference.anatomy),
        head_gain,
        composed.maturation_rate * reference.age_months,
        composed.maturation_rate == 1,
        composed.lean_gain,
        composed.lean_keys,
    )


def heavier(group: str, growth: MaturationFactors) -> str:
    """Return what is said of the neck's numbers, which grow with its heavier head."""
    gain = f" x {growth.head_gain:.6g}, by which head and neck are heavier than by the published law (D)"
    return gain if group == NECK else ""


def matured(origin: Origin, growth: MaturationFactors) -> Origin:
    """Return the origin of a number that follows maturity, with the child's own rate, if that is not average."""
    if growth.is_usual:
        return origin
    return origin.times(f", at a maturity of {growth.mature_months:.6g} months", RATE_KEY)


def size_gain(joint: str, group: str, growth: MaturationFactors) -> float:
    """Return s = v l², by which inertia, stiffness and damping of a joint grow, for the neck also x its heavier head.

    With the volume v of the part that the joint moves and the standing height l, both relative to 18 months, s is
    proportional to the fifth power of height in children who grow in proportion.
    """
    gain = growth.head_gain if group == NECK else 1.0
    return growth.relative_volumes[joint] * growth.relative_length**2 * gain
