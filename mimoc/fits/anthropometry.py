"""Body measurements, and the origin of each."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace

from mimoc.fits.curves import LogCurve


@dataclass(frozen=True, slots=True)
class DataPoint:
    """One point that a growth curve was fitted to."""

    age_months: float
    value_cm: float
    origin: str  # `anthrokids.csv:12`, or how it was inferred.


@dataclass(frozen=True, slots=True)
class Measured:
    """A body measurement and its origin."""

    value_m: float
    origin: str  # `anthrokids.csv: hand_breadth, log fit`.
    curve: LogCurve | None = None  # The growth curve that it was evaluated from, in cm by months; None if it was given.
    points: tuple[DataPoint, ...] = ()
    """What the curve was fitted to; empty where only published coefficients are known."""
    given_by: tuple[str, ...] = ("spec.age_months",)  # The keys of the spec that it follows from.


@dataclass(frozen=True)
class Measurements(Mapping[str, float]):
    """The measurements of one child: a mapping from AnthroKids name to metres."""

    age_months: float
    table: Mapping[str, Measured]  # By name; a name that starts with `left_` or `right_` is of that side alone.
    base: Mapping[str, Measured]  # The same child before its spec replaced any single measurement.
    paper: "Measurements | None" = None
    """The same child by the growth law of the paper, which strength and masses follow; None is itself."""
    slenderness: float = 1.0
    """Lengths over girths, relative to the average child: trunks by the published law have no measured height."""

    @property
    def paper_law(self) -> "Measurements":
        """The same child by the growth law of the paper."""
        return self.paper or self

    @property
    def unreplaced(self) -> "Measurements":
        """The same child before its spec replaced any single measurement."""
        paper = self.paper and self.paper.unreplaced
        same = self.table is self.base and paper is self.paper
        return self if same else replace(self, table=self.base, paper=paper)

    @property
    def symmetric(self) -> bool:
        """Whether no side has any measurement of its own."""
        return self.table.keys() == self.base.keys()

    def __getitem__(self, name: str) -> float:
        """Return a measurement in metres."""
        return self.table[name].value_m

    def __iter__(self) -> Iterator[str]:
        return iter(self.table)

    def __len__(self) -> int:
        return len(self.table)

    @property
    def base_m(self) -> dict[str, float]:
        """The measurements before any was replaced, in metres."""
        return {name: measured.value_m for name, measured in self.base.items()}

    def of_side(self, side: str) -> dict[str, float]:
        """Return the measurements of one side, in metres; *side* is `left`, `right`, or empty for the middle.

        The middle takes what both sides have; where they differ, it takes the side that changed less.
        """
        if self.symmetric:
            return {name: self.table[name].value_m for name in self.base}
        sides = (side,) if side else ("left", "right")

        def closest_side(name: str) -> float:
            both_m = self[name]
            values_m = (self.table.get(f"{side}_{name}", self.table[name]).value_m for side in sides)
            return min(values_m, key=lambda value_m: abs(value_m - both_m))

        return {name: closest_side(name) for name in self.base}

    def scaled(self, factors: Mapping[str, float], why: str, given_by: tuple[str, ...]) -> "Measurements":
        """Return the measurements of a child whose named ones differ by a factor, by either growth law.

        Args:
            factors: By name.
            why: Added to the origin of each.
            given_by: The keys of the spec that ask for it.
        """
        table = {
            name: Measured(
                measured.value_m * factors[name],
                f"{measured.origin}, x {factors[name]:.4f} {why}",
                measured.curve,
                measured.points,
                (*measured.given_by, *given_by),
            )
            if name in factors
            else measured
            for name, measured in self.table.items()
        }
        return Measurements(self.age_months, table, table, self.paper and self.paper.scaled(factors, why, given_by))

    def replaced(self, given: Mapping[str, Measured]) -> "Measurements":
        """Return the measurements with some of them given, of both sides or of one."""
        paper = self.paper and self.paper.replaced(given)
        return replace(self, table={**self.table, **given}, paper=paper)
