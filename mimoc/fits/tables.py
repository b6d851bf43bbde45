"""The anthropometric tables that ship with mimoc, read once."""

import csv
import math
from bisect import bisect_right
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple, TypeVar

import numpy as np

from mimoc.base.errors import DataError
from mimoc.base.units import MM_PER_CM
from mimoc.fits.curves import LogCurve
from mimoc.fits.standards import SEXES, GrowthStandard

Table = TypeVar("Table")

WHO_FILES = {
    "length_cm": "length_for_age.csv",
    "weight_kg": "weight_for_age.csv",
    "head_circumference_cm": "head_circumference_for_age.csv",
    "arm_circumference_cm": "arm_circumference_for_age.csv",
}
"""WHO's indicators, by the name and unit mimoc gives them."""


@dataclass(frozen=True, slots=True)
class GroupMean:
    """The mean of one measurement in one age group of AnthroKids."""

    first_month: int  # First completed month of age in the group.
    last_month: int  # Last completed month of age in the group.
    mean_cm: float
    line: int  # Line of the row in anthrokids.csv.


class Posture(NamedTuple):
    """What the angles at rest depend on besides age."""

    development: str
    hands: str
    chest_joint: bool
    """Whether the chest has joints of its own."""
    pose: str


@dataclass(frozen=True, slots=True)
class Postures:
    """The angles at which the average child comes to rest."""

    ages_months: tuple[float, ...]
    angles_deg: Mapping[Posture, Mapping[str, tuple[float, ...]]]  # Angles by joint, for each of the ages.


@dataclass(frozen=True, slots=True)
class GrowthTables:
    """Everything that is known of how children grow."""

    anthrokids: Mapping[str, tuple[GroupMean, ...]]  # Group means by measurement, youngest first.
    published: Mapping[str, LogCurve]  # MIMo v2's own coefficients by measurement, in cm.
    who: Mapping[str, GrowthStandard]  # WHO Child Growth Standards by indicator, in the unit of its name.
    postures: Postures  # How children of the ages lie, sit and stand.
    files: Mapping[str, bytes]  # All files of tables, by their path in the data folder.


def data_folder() -> Path:
    """Return the folder of tables: inside the package when installed, beside it in a checkout.

    Raises:
        DataError: If neither exists.
    """
    package = Path(__file__).resolve().parents[1]
    for folder in (package / "data", package.parent / "data"):
        if (folder / "anthrokids.csv").is_file():
            return folder
    raise DataError(f"mimoc's tables are not in {package / 'data'}; install mimoc again")


def data_files() -> dict[str, bytes]:
    """Return every table that ships with mimoc, by its path in the data folder."""
    folder = data_folder()
    return {path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*.csv"))}


@cache
def load_tables() -> GrowthTables:
    """Return the tables that ship with mimoc; raise a DataError if one is missing or damaged."""
    folder = data_folder()
    return GrowthTables(
        anthrokids=MappingProxyType(_read(_read_anthrokids, folder / "anthrokids.csv")),
        published=MappingProxyType(_read(_read_published, folder / "anthrokids_published_fits.csv")),
        who=MappingProxyType({name: _read(_read_who, folder / "who" / file) for name, file in WHO_FILES.items()}),
        postures=_read(_read_postures, folder / "postures.csv"),
        files=MappingProxyType(data_files()),
    )


def settled_deg(development: str, hands: str, chest_joint: bool, pose: str, age_months: float) -> dict[str, float]:
    """Return the angles at which the average child of an age rests in a pose, linear between the ages of the table.

    Args:
        development: The law that its joints follow.
        hands: Their kind.
        chest_joint: Whether the chest has joints of its own.
        pose: Name of the pose.
        age_months: From 0 to 24.

    Returns:
        Angles by joint; `{side}` stands for both sides.
    """
    postures = load_tables().postures
    ages = postures.ages_months
    after = min(bisect_right(ages, age_months), len(ages) - 1)
    share = (age_months - ages[after - 1]) / (ages[after] - ages[after - 1])
    return {
        joint: angles[after - 1] + share * (angles[after] - angles[after - 1])
        for joint, angles in postures.angles_deg.get(Posture(development, hands, chest_joint, pose), {}).items()
    }


def _read(reader: Callable[[Path], Table], path: Path) -> Table:
    try:
        return reader(path)
    except (OSError, ValueError, KeyError, TypeError, csv.Error) as error:
        raise DataError(f"{path}: this table is missing or damaged ({error}); install mimoc again") from None


def _read_anthrokids(path: Path) -> dict[str, tuple[GroupMean, ...]]:
    groups: dict[str, list[GroupMean]] = {}
    for line, row in _rows(path, "measurement", "first_month"):
        mean = GroupMean(int(row["first_month"]), int(row["last_month"]), _finite(row["mean"]), line)
        groups.setdefault(row["measurement"], []).append(mean)
    return {name: tuple(sorted(means, key=lambda mean: mean.first_month)) for name, means in groups.items()}


def _read_published(path: Path) -> dict[str, LogCurve]:
    curves = {}
    for _, row in _rows(path, "measurement"):
        per_cm = MM_PER_CM if row["unit"] == "mm" else 1.0
        a, b, c = (_finite(row[coefficient]) for coefficient in "abc")
        curves[row["measurement"]] = LogCurve(a / per_cm, b, c / per_cm)
    return curves


def _read_who(path: Path) -> GrowthStandard:
    sexes = np.loadtxt(path, delimiter=",", skiprows=1, usecols=0, dtype=str)
    numbers = np.loadtxt(path, delimiter=",", skiprows=1, usecols=(1, 2, 3, 4))
    if not np.isfinite(numbers).all() or not set(SEXES) <= set(sexes):
        raise ValueError("not a number for every sex and day")
    return GrowthStandard({sex: numbers[sexes == sex] for sex in SEXES})


def _read_postures(path: Path) -> Postures:
    ages: tuple[str, ...] = ()
    postures: dict[Posture, dict[str, tuple[float, ...]]] = {}
    for _, row in _rows(path, "development", "hands", "chest_joint", "pose", "joint"):
        ages = tuple(row)[5:]
        posture = Posture(row["development"], row["hands"], row["chest_joint"] == "true", row["pose"])
        postures.setdefault(posture, {})[row["joint"]] = tuple(_finite(row[age]) for age in ages)
    return Postures(tuple(map(float, ages)), postures)


def _finite(text: str) -> float:
    number = float(text)
    if not math.isfinite(number):
        raise ValueError(f"'{text}' is not a measurement")
    return number


def _rows(path: Path, *keys: str) -> Iterator[tuple[int, dict[str, str]]]:
    """Yield the line number and the fields of each row, of which no two may have the same values under *keys*."""
    lines: dict[tuple[str, ...], int] = {}
    with path.open(encoding="utf-8", newline="") as file:
        reader = csv.DictReader(file)
        if len(set(names := reader.fieldnames or ())) < len(names):
            raise ValueError("two columns have the same name")
        for line, row in enumerate(reader, start=2):
            key = tuple(row[name] for name in keys)
            if (first := lines.setdefault(key, line)) != line:
                raise ValueError(f"lines {first} and {line} are both of {', '.join(key)}")
            yield line, row
