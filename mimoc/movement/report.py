"""What is said of some infants' movement: measures, scores, distances, and whether they are told from others."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from mimoc.motion.point_recording import PointRecording
from mimoc.motion.points import SIDES
from mimoc.movement.classifier import WINDOW_S, Windows, told_apart, windows_of
from mimoc.movement.filming import Filmed
from mimoc.movement.joints import joint_measures
from mimoc.movement.measured import measure_movement
from mimoc.movement.real_infants import told_from_real
from mimoc.movement.sample import Sample, distance, standard_scores
from mimoc.movement.sides import measure_sides
from mimoc.movement.trunk_frame import stand_ins
from mimoc.quantities import QUANTITIES

SPEEDS, APART = ("hand_speed_median_trunk_s", "foot_speed_median_trunk_s"), 2.0
"""Speeds that tell whether sides differ, and from which ratio on they do; a choice."""
DIGITS = 6
"""Significant digits of numbers in files."""


@dataclass(frozen=True)
class ToldApart:
    """How well a classifier tells two groups of infants apart by windows of 8 s."""

    accuracy: float
    """Balanced accuracy, with whole infants left out; .5 is chance."""
    exact: bool
    """Whether the other group are recordings; or else windows drawn from the aggregates of a sample."""
    deviation: float | None = None
    """Standard deviation over the draws."""


@dataclass(frozen=True)
class MovementMeasures:
    """The measures of some infants, and of the sample that they are compared with."""

    names: tuple[str, ...]
    """What each infant is called."""
    infants: tuple[Mapping[str, float], ...]
    """Measures of each, by the name of the quantity."""
    sample: Sample | None = None
    apart: ToldApart | None = None
    notes: tuple[str, ...] = ()
    sides: Mapping[str, tuple[Mapping[str, float], ...]] = field(default_factory=dict)
    """The measures of each that a side has, by `left` and `right`."""
    beside: Mapping[str, "MovementMeasures"] = field(default_factory=dict)
    """Those of counterparts of an infant, by what they are, such as `healthy`."""

    @property
    def means(self) -> dict[str, float]:
        """Mean over infants of each measure that any of them has."""
        return _means(self.infants)

    @property
    def side_means(self) -> dict[str, dict[str, float]]:
        """The same of each side, by `left` and `right`."""
        return {side: _means(infants) for side, infants in self.sides.items()}

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
    def distance(self) -> float | None:
        """Distance of the mean over infants to the sample."""
        return distance(self.means, self.sample) if self.sample else None

    def to_data(self) -> dict[str, Any]:
        """Return it as plain data for JSON, numbers to six digits."""
        measures = {
            name: {
                "label": QUANTITIES[name].label,
                "unit": QUANTITIES[name].unit,
                "mean": _short(mean),
                "infants": [_short(one[name]) if name in one else None for one in self.infants],
                **self._of_sides(name),
                **self._compared(name),
            }
            for name, mean in self.means.items()
        }
        data: dict[str, Any] = {"infants": list(self.names), "measures": measures, "notes": list(self.notes)}
        if self.beside:
            data["beside"] = {name: other.to_data() for name, other in self.beside.items()}
        if self.sample:
            data["against"] = {"name": self.sample.name, "infants": self.sample.infants}
            data["distance"] = {"of_mean": _short(self.distance), "infants": [_short(one) for one in self.distances]}
        if self.apart:
            data["told_apart"] = {
                "balanced_accuracy": _short(self.apart.accuracy),
                "window_s": WINDOW_S,
                "exact": self.apart.exact,
                "sd_over_draws": _short(self.apart.deviation),
            }
        return data

    def _of_sides(self, name: str) -> dict[str, Any]:
        return {
            side: {"mean": _short(means[name]), "infants": [_short(one.get(name)) for one in self.sides[side]]}
            for side, means in self.side_means.items()
            if name in means
        }

    def _compared(self, name: str) -> dict[str, Any]:
        if self.sample is None or name not in self.sample.means:
            return {}
        return {
            "sample_mean": _short(self.sample.means[name]),
            "sample_sd": _short(self.sample.deviations[name]),
            "score": _short(self.scores[name]),
        }


def _means(infants: Sequence[Mapping[str, float]]) -> dict[str, float]:
    names = [name for name in QUANTITIES if any(name in one for one in infants)]
    return {name: float(np.mean([one[name] for one in infants if name in one])) for name in names}


def measure_all(films: Sequence[Filmed]) -> MovementMeasures:
    """Return the measures of some infants.

    Raises:
        MovementError: If one cannot be measured.
    """
    infants, notes = [], dict[str, None]()
    for film in films:
        infants.append(measure_movement(film.seen) | (joint_measures(film.space) if film.space else {}))
        notes |= dict.fromkeys(film.seen.notes) | dict.fromkeys(_assumptions(film.seen))
    by_film = [measure_sides(film.seen, film.space) for film in films]
    sides = {side: tuple(one[side] for one in by_film) for side in SIDES}
    return MovementMeasures(tuple(film.seen.name for film in films), tuple(infants), notes=tuple(notes), sides=sides)


def compare(
    films: Sequence[Filmed],
    sample: Sample | Sequence[PointRecording],
    generator: np.random.Generator,
) -> MovementMeasures:
    """Return the measures of some infants beside those of others, and whether the two are told apart.

    Args:
        films: The infants.
        sample: The aggregates of a sample, those of `real_infants()`; or recordings, for the exact figure.
        generator: Draws windows from the aggregates.

    Raises:
        MovementError: If one cannot be measured.
    """
    measured, seen = measure_all(films), [film.seen for film in films]
    apart = None
    if min(one.frames / one.rate_hz for one in seen) >= WINDOW_S and (windows := windows_of(seen)).are_enough:
        apart = _told_apart(windows, sample, generator)
    few = f"not told apart: this needs two infants or seeds, and two windows of {WINDOW_S:g} s besides those of any one"
    if not isinstance(sample, Sample):
        sample = Sample.of([measure_movement(recording) for recording in sample], f"{len(sample)} recordings")
    notes = measured.notes if apart else (*measured.notes, few)
    return replace(measured, sample=sample, apart=apart, notes=notes)


def _told_apart(
    windows: Windows, sample: Sample | Sequence[PointRecording], generator: np.random.Generator
) -> ToldApart:
    if isinstance(sample, Sample):
        accuracy, deviation = told_from_real(windows, generator)
        return ToldApart(accuracy, False, deviation)
    return ToldApart(told_apart(windows_of(sample), windows), True)


def _assumptions(recording: PointRecording) -> list[str]:
    """Return what has to be known to read the measures of a recording."""
    less = "and moves less: its speeds come out lower"
    notes = [f"{present} stands in for {absent}, {less}" for absent, present in stand_ins(recording.names).items()]
    if recording.unit == "m":
        notes.append("points in space are measured as from straight above, by x and y")
    return notes


def _short(value: float | None) -> float | None:
    return None if value is None else float(f"{value:.{DIGITS}g}")
