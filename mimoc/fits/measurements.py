"""What was measured on a child, and why to believe it."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from mimoc.fits.curves import LogCurve


@dataclass(frozen=True, slots=True)
class DataPoint:
    """One point that a growth curve was fitted to."""

    age_months: float
    value_cm: float
    origin: str
    """`anthrokids.csv:12`, or how it was inferred."""


@dataclass(frozen=True, slots=True)
class Measured:
    """A body measurement and the reason to believe it."""

    value_m: float
    origin: str
    """`anthrokids.csv: hand_breadth, log fit`."""
    curve: LogCurve
    """The growth curve it was read off, in cm by months."""
    points: tuple[DataPoint, ...]
    """What the curve was fitted to; empty where only published coefficients are known."""


@dataclass(frozen=True)
class Measurements(Mapping[str, float]):
    """The measurements of one child: a mapping from AnthroKids name to metres."""

    age_months: float
    table: Mapping[str, Measured]

    def __getitem__(self, name: str) -> float:
        """Return a measurement in metres."""
        return self.table[name].value_m

    def __iter__(self) -> Iterator[str]:
        return iter(self.table)

    def __len__(self) -> int:
        return len(self.table)
