"""What is said of some infants' movement: measures, scores, distances, and whether they are told from others."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from mimoc.base.errors import MovementError
from mimoc.base.quantities import QUANTITIES
from mimoc.motion.labels import SIDES
from mimoc.motion.point_recording import PointRecording
from mimoc.movement.filming import Filmed, Progress, no_progress
from mimoc.movement.measured import joint_measures, measure_movement, measure_sides
from mimoc.movement.measures import MIN_S, stand_ins, trunk_paths
from mimoc.movement.sample import (
    WINDOW_S,
    Sample,
    Windows,
    accuracy_against_real,
    balanced_accuracy,
    balanced_accuracy_error,
    distance,
    standard_scores,
    windows_of,
)

SPEEDS, APART = ("hand_speed_median_trunk_s", "foot_speed_median_trunk_s"), 2.0
"""Speeds that tell whether sides differ, and from which ratio on they do; a choice."""
DIGITS = 6


@dataclass(frozen=True)
class ClassifierAccuracy:
    """How well a classifier tells two groups of infants apart by windows of 8 s."""

    accuracy: float  # Balanced accuracy, with whole infants left out; .5 is chance.
    exact: bool  # Whether the other group are recordings; or else windows drawn from the aggregates of a sample.
    deviation: float  # Standard deviation over the draws; of recordings, the standard error, from how infants differ.
    windows: int  # How many windows there are of the infants that are measured.


@dataclass(frozen=True, slots=True)
class Spread:
    """How far the values that a mean is of are apart."""

    n: int  # How many there are: infants or, of one infant, windows of its recording.
    sd: float | None  # Standard deviation (n - 1); None of a single value.


@dataclass(frozen=True)
class MovementMeasures:
    """The measures of some infants, and of the sample that they are compared with."""

    names: tuple[str, ...]
    infants: tuple[Mapping[str, float], ...]  # Measures of each, by the name of the quantity.
    sample: Sample | None = None
    apart: ClassifierAccuracy | None = None
    notes: tuple[str, ...] = ()
    sides: Mapping[str, tuple[Mapping[str, float], ...]] = field(default_factory=dict)
    """The measures of each that a side has, by `left` and `right`."""
    windows: "MovementMeasures | None" = None
    """Measures of the windows that the recording of one infant is divided into; None if it is too short."""
    window_s: float | None = None  # Length of each of these windows.
    beside: Mapping[str, "MovementMeasures"] = field(default_factory=dict)
    """Measures of counterparts of an infant, by what they are, such as `healthy`."""

    @property
    def means(self) -> dict[str, float]:
        """Mean over infants of each measure that any of them has."""
        return _means(self.infants)

    @property
    def side_means(self) -> dict[str, dict[str, float]]:
        """The same of each side, by `left` and `right`."""
        return {side: _means(infants) for side, infants in self.sides.items()}

    @property
    def spreads(self) -> dict[str, Spread]:
        """How far infants or, of a single one, windows of its recording are apart, by measure."""
        return _spreads(self.means, self.infants if self.windows is None else self.windows.infants)

    @property
    def side_spreads(self) -> dict[str, dict[str, Spread]]:
        """The same of each side, by `left` and `right`."""
        rows = (self if self.windows is None else self.windows).sides
        return {side: _spreads(means, rows[side]) for side, means in self.side_means.items()}

    @property
    def spread_is_over(self) -> str:
        """What these are spreads of, in words."""
        return "infants" if self.windows is None else f"windows of {self.window_s:g} s"

    @property
    def sides_differ(self) -> bool:
        """Whether a hand or a foot is `APART` times as fast as the other, in the median."""
        pairs = [[means.get(name, 0.0) for means in self.side_means.values()] for name in SPEEDS]
        return any(max(pair) > APART * min(pair) for pair in pairs if pair)

    @property
    def scores(self) -> dict[str, float]:
        """Standard scores of these means in the sample."""
        return standard_scores(self.means, self.sample) if self.sample else {}

    @property
    def distances(self) -> tuple[float, ...]:
        """Distance of each infant to the sample."""
        return tuple(distance(one, self.sample) for one in self.infants) if self.sample else ()

    @property
    def window_distances(self) -> tuple[float, ...]:
        """Distance of each window of a single infant's recording to the sample."""
        return tuple(distance(one, self.sample) for one in self.windows.infants) if self.sample and self.windows else ()

    @property
    def distance(self) -> float | None:
        """Distance of the mean over infants to the sample."""
        return distance(self.means, self.sample) if self.sample else None

    def to_data(self) -> dict[str, Any]:
        """Return it as plain data for JSON, numbers to six digits."""
        spreads, side_means, side_spreads = self.spreads, self.side_means, self.side_spreads
        measures: dict[str, dict[str, Any]] = {}
        for name, mean in self.means.items():
            quantity = QUANTITIES[name]
            values = [_short(one.get(name)) for one in self.infants]
            measures[name] = {
                "label": quantity.label,
                "unit": quantity.unit,
                **_statistics(mean, spreads[name], values),
            }
            for side, means in side_means.items():
                if name in means:
                    values = [_short(one.get(name)) for one in self.sides[side]]
                    measures[name][side] = _statistics(means[name], side_spreads[side][name], values)
            measures[name] |= self._compared(name)
        data: dict[str, Any] = {"infants": list(self.names), "measures": measures, "notes": list(self.notes)}
        data["spread_is_over"] = self.spread_is_over
        if self.beside:
            data["beside"] = {name: other.to_data() for name, other in self.beside.items()}
        if self.sample:
            data["against"] = {"name": self.sample.name, "infants": self.sample.infants}
            data["distance"] = {"of_mean": _short(self.distance), "infants": [_short(one) for one in self.distances]}
            if self.windows:
                data["distance"]["windows"] = [_short(one) for one in self.window_distances]
        if self.apart:
            data["told_apart"] = {
                "balanced_accuracy": _short(self.apart.accuracy),
                "window_s": WINDOW_S,
                "exact": self.apart.exact,
                "windows": self.apart.windows,
                "standard_error" if self.apart.exact else "sd_over_draws": _short(self.apart.deviation),
            }
        return data

    def _compared(self, name: str) -> dict[str, Any]:
        if self.sample is None or name not in self.sample.means:
            return {}
        return {
            "sample_mean": _short(self.sample.means[name]),
            "sample_sd": _short(self.sample.deviations[name]),
            "sample_n": self.sample.infants,
            "score": _short(self.scores[name]),
        }


def _means(infants: Sequence[Mapping[str, float]]) -> dict[str, float]:
    names = [name for name in QUANTITIES if any(name in one for one in infants)]
    return {name: float(np.mean([one[name] for one in infants if name in one])) for name in names}


def _spreads(means: Mapping[str, float], rows: Sequence[Mapping[str, float]]) -> dict[str, Spread]:
    spreads = {}
    for name in means:
        values = [one[name] for one in rows if name in one]
        spreads[name] = Spread(len(values), float(np.std(values, ddof=1)) if len(values) > 1 else None)
    return spreads


def _statistics(mean: float, spread: Spread, values: Sequence[float | None]) -> dict[str, Any]:
    return {"mean": _short(mean), "n": spread.n, "sd": _short(spread.sd), "infants": values}


def measure_all(films: Sequence[Filmed], progress: Progress = no_progress) -> MovementMeasures:
    """Return the measures of some infants; MovementError if one cannot be measured."""
    measured = _measured(films, progress)
    if len(films) > 1:
        return measured
    seconds = films[0].seen.frames / films[0].seen.rate_hz
    window_s = WINDOW_S if seconds >= 2 * WINDOW_S else float(int(seconds / 2))
    if window_s < MIN_S:
        few = f"no spread is known: one recording of less than {2 * MIN_S:g} s cannot be divided"
        return replace(measured, notes=(*measured.notes, few))
    windows = _measured(list(_windows(films[0], window_s)))
    return replace(measured, windows=windows, window_s=window_s)


def _windows(film: Filmed, window_s: float) -> Iterator[Filmed]:
    """Yield the whole windows that a film has, and in which all is seen that measures need."""
    frames = round(window_s * film.seen.rate_hz)
    for start in range(0, film.seen.frames - frames + 1, frames):
        stop = start + frames
        window = Filmed(film.seen.window(start, stop), film.space and film.space.window(start, stop))
        with suppress(MovementError):  # A point that is needed is not seen in it.
            trunk_paths(window.seen)
            yield window


def _measured(films: Sequence[Filmed], progress: Progress = no_progress) -> MovementMeasures:
    infants, notes = [], dict[str, None]()
    for count, film in enumerate(films):
        progress(count, len(films))
        infants.append(measure_movement(film.seen) | (joint_measures(film.space) if film.space else {}))
        notes |= dict.fromkeys(film.seen.notes) | dict.fromkeys(_assumptions(film.seen))
    by_film = [measure_sides(film.seen, film.space) for film in films]
    sides = {side: tuple(one[side] for one in by_film) for side in SIDES}
    return MovementMeasures(tuple(film.seen.name for film in films), tuple(infants), notes=tuple(notes), sides=sides)


def compare(
    films: Sequence[Filmed],
    sample: Sample | Sequence[PointRecording],
    generator: np.random.Generator,
    progress: Progress = no_progress,
) -> MovementMeasures:
    """Return the measures of infants beside a sample's, and whether the two are told apart, or raise a MovementError.

    The sample is `real_infants()`, or recordings, for the exact figure; the generator draws windows from the
    aggregates.
    """
    measured, apart = measure_all(films, progress), None
    notes = measured.notes
    try:
        apart = _told_apart(windows_of([film.seen for film in films]), sample, generator)
    except MovementError as error:
        notes = (*notes, f"not told apart: {error}")
    if not isinstance(sample, Sample):
        sample = Sample.of([measure_movement(recording) for recording in sample], f"{len(sample)} recordings")
    return replace(measured, sample=sample, apart=apart, notes=notes)


def _told_apart(
    windows: Windows, sample: Sample | Sequence[PointRecording], generator: np.random.Generator
) -> ClassifierAccuracy:
    if isinstance(sample, Sample):
        accuracy, deviation = accuracy_against_real(windows, generator)
        return ClassifierAccuracy(accuracy, False, deviation, len(windows.values))
    others = windows_of(sample)
    error = balanced_accuracy_error(others, windows)
    return ClassifierAccuracy(balanced_accuracy(others, windows), True, error, len(windows.values))


def _assumptions(recording: PointRecording) -> list[str]:
    less = "and moves less: its speeds come out lower"
    notes = [f"{present} stands in for {absent}, {less}" for absent, present in stand_ins(recording.names).items()]
    if recording.unit == "m":
        notes.append("points in space are measured as from straight above, by x and y")
    return notes


def _short(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.{DIGITS}g}")
