"""The sizes of a body that several keys of a spec can name: what contradicts itself, and what is there twice."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from statistics import NormalDist

from mimoc.schema.base import KeyedError, KeyPath, dotted
from mimoc.schema.body import INDICATORS, BodySpec
from mimoc.schema.names import LIMB_MEASUREMENTS, SIDES, unsided
from mimoc.schema.source import Source

MEASUREMENT_OF: Mapping[str, str] = {
    "length_cm": "crown_sole_length",
    "head_circumference_cm": "head_circumference",
}
"""The AnthroKids measurement that is the same size as a measure of an individual; weight is none."""

CHART_DIGIT = 0.1
"""Last digit of WHO's charts, in cm and in kg: a percentile and a measure are the same if they agree to half of it."""


@dataclass(frozen=True, slots=True)
class Naming:
    """A key of a spec that names a size, or several."""

    path: KeyPath
    value: float  # In cm or kg; or a percentile.
    sizes: frozenset[str]  # Names of measurements, those of limbs with their side; `weight_kg` is the weight.
    percentile_of: str = ""  # The measure whose percentile this is, by the name of its key; empty if it is none.

    def is_side_of(self, other: "Naming") -> bool:
        """Whether it is of one side of what another one is of, where it counts in its place."""
        return self.sizes < other.sizes

    def measure(self, body: BodySpec, age_months: float) -> float:
        """Return the value in cm or kg, that of a percentile by WHO's standard for the child's sex and age."""
        if not self.percentile_of:
            return self.value
        from mimoc.fits import load_tables  # Bundles are opened without tables of growth.

        sex = (body.individual and body.individual.sex) or "female"  # The schema requires a sex with a percentile.
        return load_tables().who[self.percentile_of].value(NormalDist().inv_cdf(self.value / 100), age_months, sex)

    def said(self, body: BodySpec, age_months: float) -> str:
        """Return the value with its unit, for messages."""
        unit = "kg" if "weight_kg" in self.sizes else "cm"
        if self.percentile_of:
            return f"percentile {self.value:g}, {self.measure(body, age_months):.1f} {unit}"
        return f"{self.value:.10g} {unit}"


def namings(body: BodySpec) -> Iterator[Naming]:
    """Yield every key of a body that names a size, in the order of precedence: a later one says more of fewer parts.

    1. Percentiles of the individual, and 2. its cm and kg: of the whole child.
    3. Measurements of both sides, and 4. of one side: in place of what follows from age and individual.

    Factors of parts name no size: they are on what the part would be otherwise.
    """
    for measure, percentile in INDICATORS.items() if body.individual else ():
        sizes = frozenset({MEASUREMENT_OF.get(measure, measure)})
        for key, percentile_of in ((percentile, measure), (measure, "")):
            value = getattr(body.individual, key)
            if value is not None:
                yield Naming(("body", "individual", key), value, sizes, percentile_of)
    for key in sorted(body.measurements, key=lambda key: (key.startswith(SIDES), key)):
        yield Naming(("body", "measurements", key), body.measurements[key], _sizes(key.removesuffix("_cm")))


def pairs(body: BodySpec, age_months: float) -> Iterator[tuple[Naming, Naming, bool]]:
    """Yield each two keys that name one size, the earlier by precedence first, and whether both may stand.

    They may if they say the same, or if the later one is of one side.
    """
    before: list[Naming] = []
    for naming in namings(body):
        for other in before:
            if naming.sizes & other.sizes:
                yield other, naming, naming.is_side_of(other) or _agree(other, naming, body, age_months)
        before.append(naming)


def check_sizes(body: BodySpec, age_months: float, written: object = None) -> None:
    """Check that no size has two values at an age; the message has lines of the file, if the spec was written in one.

    Raises:
        KeyedError: If one has; at the key that says more, naming the other.
    """
    for other, naming, may_stand in pairs(body, age_months):
        if may_stand:
            continue
        line = written.locate(other.path)[0] if isinstance(written, Source) and written.has_lines else 0
        place = f"'{dotted(other.path)}'" + (f" in line {line}" if line else "")
        value = naming.said(body, age_months)
        message = f"{value} contradicts {place}, which is {other.said(body, age_months)}; leave one of the two out"
        raise KeyedError(naming.path, message, against=other.path)


def _sizes(measurement: str) -> frozenset[str]:
    """Return the sizes that a measurement is of: those of both sides, unless it has one."""
    if unsided(measurement) not in LIMB_MEASUREMENTS or measurement != unsided(measurement):
        return frozenset({measurement})
    return frozenset(f"{side}_{measurement}" for side in SIDES)


def _agree(earlier: Naming, later: Naming, body: BodySpec, age_months: float) -> bool:
    apart = abs(later.value - earlier.measure(body, age_months))
    return apart <= (CHART_DIGIT / 2 if earlier.percentile_of else 0)
