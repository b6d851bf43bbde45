"""What tells an individual child's strength from that of its size and age: how lean it is, and how fast it matures.

Only the lean part of a body is strong. With the share F of fat in the weight, and F_0 that of the average child of the
same age, the strength of each part but the neck is that of its volume times

    (1 - F) / (1 - F_0)

Where the spec does not give the fat, it follows from length and weight: F = F_0 b, with the volume b of trunk and limbs
relative to a child of the same length with the average child's proportions (D). So .83 of the weight that a newborn has
above what its length asks for is free of fat, and .48 at 6 months. Perng et al. 2017 (Am J Clin Nutr 106: 559, S) find
.34 of .46 kg for each SD of newborns' weight, and that at 5 months weight for length goes with fat more than with lean.

A child born early has 3 % more fat at term, and no more from 3 months on (`mimoc.fits.preterm`).

A child of rate k is as mature at age t as the average child at k t: strength beyond what size explains, muscle tone,
ranges of joints, fists and grasp. Size, proportions, delays, noise and acuity follow the age itself (D).
"""

from dataclasses import dataclass
from statistics import NormalDist

from mimoc.fits import Measurements, fat, preterm
from mimoc.schema.body import FAT, IndividualSpec
from mimoc.schema.infant import InfantSpec

SIZES = ("length_percentile", "length_cm", "weight_percentile", "weight_kg")
"""Keys of an individual that its build follows from."""
RATE_KEY = "spec.body.individual.maturation_rate"


@dataclass(frozen=True, slots=True)
class Composition:
    """What an individual child's strength follows, besides age and size; by default, the average child's."""

    maturation_rate: float = 1.0
    lean_gain: float = 1.0
    """Lean share of the body, relative to the average child of the same age."""
    lean_keys: tuple[str, ...] = ()
    """Keys of the spec that it follows from, unless it is 1."""

    def of_size(self) -> "Composition":
        """Return that of a child that matures at the same rate, and is as lean as the average child."""
        return Composition(self.maturation_rate)


AVERAGE = Composition()


def composition(child: Measurements, spec: InfantSpec) -> Composition:
    """Return the composition of a spec's child that has been measured."""
    individual, early = spec.body.individual or IndividualSpec.model_construct(), spec.birth_keys
    if spec.body.individual is None and not early:
        return AVERAGE
    usual, percent = fat.mean_percent(child.age_months), _fat_percent(child, individual, spec.months_early)
    gain = 1.0 if percent == usual else (100 - percent) / (100 - usual)
    given = [key for key in FAT if getattr(individual, key) is not None]
    sizes = [key for key in SIZES if getattr(individual, key)]
    keys = *(f"spec.body.individual.{key}" for key in given or sizes), *(() if given else early)
    return Composition(individual.maturation_rate or 1.0, gain, keys if gain != 1 else ())


def _fat_percent(child: Measurements, individual: IndividualSpec, months_early: float) -> float:
    if individual.fat_percent is not None:
        return individual.fat_percent
    if individual.fat_percentile is not None:
        return fat.percent(NormalDist().inv_cdf(individual.fat_percentile / 100), child.age_months)
    more = preterm.more_fat_percent(months_early, child.age_months)
    build = child.slenderness**2 if any(getattr(individual, key) is not None for key in SIZES) else 1.0
    return (fat.mean_percent(child.age_months) + more) / build
