"""Samples of infants: how far an infant is from one, and whether a classifier tells two apart by windows of movement.

The twelve real infants of MINI-RGBD (Hesse et al. 2018, ECCV workshops) are here as aggregates only: means and
deviations of their measures, and of windows of 8 s. They are supine, awake, up to 7 months old, 33 s each, at 30
frames/s as was assumed. Four of the twelve are labelled as lacking normal fidgety movements. `sculpt/real_infants.py`
made the files from keypoints, which mimoc neither contains nor downloads.
"""

import csv
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MovementError
from mimoc.base.movement_quantities import CORE
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.movement.measures import core_measures

MAX_SCORE = 10.0  # Scores beyond it count as this in a distance, so that one measure alone does not decide.


@dataclass(frozen=True)
class Sample:
    """Infants whose movement was measured, as aggregates only."""

    name: str
    infants: int
    means: Mapping[str, float]  # By the name of the quantity.
    deviations: Mapping[str, float]  # Standard deviations between infants (n - 1).

    @classmethod
    def of(cls, measures: Sequence[Mapping[str, float]], name: str = "sample") -> "Sample":
        """Return the sample of at least two infants, by the measures that all of them have."""
        names = [key for key in measures[0] if all(key in one for one in measures)]
        values = {key: np.array([one[key] for one in measures]) for key in names}
        means = {key: float(one.mean()) for key, one in values.items()}
        return cls(name, len(measures), means, {key: float(one.std(ddof=1)) for key, one in values.items()})


def standard_scores(measures: Mapping[str, float], sample: Sample) -> dict[str, float]:
    """Return by how many standard deviations each measure that the sample has lies above its mean."""
    return {
        key: (value - sample.means[key]) / (sample.deviations[key] + 1e-9)
        for key, value in measures.items()
        if key in sample.means
    }


def distance(measures: Mapping[str, float], sample: Sample) -> float:
    """Return how far an infant is from a sample: the root mean square of the scores of the 21 measures.

    Each score is clipped at +-10. An infant of MINI-RGBD is .77-1.57 from the other 11, median 1.12.
    """
    scores = standard_scores({quantity.name: measures[quantity.name] for quantity in CORE}, sample)
    return float(np.sqrt(np.mean(np.clip([*scores.values()], -MAX_SCORE, MAX_SCORE) ** 2)))


IntArray = npt.NDArray[np.integer]
BoolArray = npt.NDArray[np.bool_]
WINDOW_S = 8.0
SHRINKAGE = 0.5  # Share of the covariance that is shrunk to its diagonal.
RIDGE = 0.05  # Added to the variances of the standardised measures.
MAX_STANDARDISED = 4.0  # Standardised measures are clipped at it.


@dataclass(frozen=True)
class Windows:
    """The 21 measures of windows of 8 s of some infants."""

    values: FloatArray  # Shape (w, 21), in the order of `mimoc.base.movement_quantities.CORE`.
    infants: IntArray  # Which infant each is of, shape (w,).

    @property
    def are_enough(self) -> bool:
        """Whether two windows of other infants are left for whichever infant is left out."""
        most = int(np.bincount(self.infants).max())
        return len(self.infants) - most >= 2  # Covariances need two.


def windows_of(recordings: Sequence[PointRecording]) -> Windows:
    """Return the measures of all whole windows of 8 s of recordings, one infant each, or raise a MovementError."""
    rows, infants = [], []
    for infant, recording in enumerate(recordings):
        frames = round(WINDOW_S * recording.rate_hz)
        if recording.frames < frames:
            short = f"is {recording.frames / recording.rate_hz:.1f} s long"
            raise MovementError(f"{recording.name}: {short}; to be told apart it needs at least {WINDOW_S:g} s")
        for start in range(0, recording.frames - frames + 1, frames):
            rows.append([*core_measures(recording.window(start, start + frames)).values()])
            infants.append(infant)
    return Windows(np.array(rows), np.array(infants))


def balanced_accuracy(first: Windows, second: Windows) -> float:
    """Return the balanced accuracy at which windows of two groups of infants are told apart; .5 is chance.

    Each infant in turn is left out, and its windows are classified by all others. A value below .5 says that an
    infant differs more from the others of its group than the groups from each other.

    Raises:
        MovementError: If a group is too small: it must have two windows when an infant is left out.
    """
    return float(np.mean([right.mean() for right in _recognised(first, second)]))


def balanced_accuracy_error(first: Windows, second: Windows) -> float:
    """Return the standard error of this accuracy, from how much the shares of infants differ within each group.

    With s_g the standard deviation of the shares of windows of the n_g infants of a group that are recognised, it is
    the root of the sum of s_g^2 / n_g over both groups, divided by 2.
    """
    squares = 0.0
    for right, group in zip(_recognised(first, second), (first, second), strict=True):
        shares = [right[group.infants == infant].mean() for infant in np.unique(group.infants)]
        squares += float(np.var(shares, ddof=1)) / len(shares)
    return squares**0.5 / 2


def _recognised(first: Windows, second: Windows) -> tuple[BoolArray, BoolArray]:
    """Return which windows of each group are taken for its own by a classifier that does not know their infant."""
    if not (first.are_enough and second.are_enough):
        few = "two infants or seeds, or more, and two windows of 8 s besides those of any one"
        raise MovementError(f"each group needs {few}; give more or longer recordings")
    values = np.concatenate([first.values, second.values])
    labels = np.repeat([False, True], [len(first.values), len(second.values)])
    infants = np.concatenate([first.infants, second.infants + first.infants.max() + 1])
    right = np.empty(len(values), bool)
    for infant in np.unique(infants):
        held_out = infants == infant
        is_second = _classify(values[~held_out], labels[~held_out], values[held_out])
        right[held_out] = is_second == labels[held_out]
    return right[~labels], right[labels]


def _classify(values: FloatArray, labels: BoolArray, unknown: FloatArray) -> BoolArray:
    """Return which of some unknown windows are of the second group, by a linear discriminant.

    With m_1, m_2 the means of the standardised windows of both groups and S the mean of their covariances, a window x
    is of the second if w . x > w . (m_1 + m_2) / 2, where w = (S / 2 + diag(S) / 2 + .05)^-1 (m_2 - m_1).
    """
    mean, deviation = values.mean(axis=0), values.std(axis=0) + 1e-9
    known, new = (np.clip((rows - mean) / deviation, -MAX_STANDARDISED, MAX_STANDARDISED) for rows in (values, unknown))
    groups = [known[labels == label] for label in (False, True)]
    within = sum(np.cov(group.T) for group in groups) / 2
    shrunk = (1 - SHRINKAGE) * within + np.diag(SHRINKAGE * np.diag(within) + RIDGE)
    means = [group.mean(axis=0) for group in groups]
    direction = np.linalg.solve(shrunk, means[1] - means[0])
    return new @ direction > (means[0] + means[1]) @ direction / 2


NAME = "12 real infants (MINI-RGBD)"
INFANTS, WINDOWS = 12, 4  # How many there are, and windows of each.
DISTANCES = 0.77, 1.12, 1.57  # Least, median and largest distance of one of them from the other 11.
FLOOR = 0.48, 0.12
"""Mean and standard deviation of the accuracy at which six of them are told from the other six, over all 462 ways to
divide them; .73 for those of odd and even numbers."""
DRAWS = 20  # Samples of real infants' windows that are drawn from their aggregates.
FILES = Path(__file__).with_name("real_infants.csv"), Path(__file__).with_name("real_windows.csv")


@cache
def real_infants() -> Sample:
    """Return the sample of the real infants."""
    with FILES[0].open(encoding="utf-8", newline="") as file:
        rows = {row["measure"]: (float(row["mean"]), float(row["sd"])) for row in csv.DictReader(file)}
    means, deviations = ({name: row[column] for name, row in rows.items()} for column in (0, 1))
    return Sample(NAME, INFANTS, means, deviations)


@cache
def real_windows() -> tuple[FloatArray, FloatArray, FloatArray]:
    """Return mean, covariance between infants and covariance within infants of the 21 measures of windows of 8 s.

    Shapes (21,), (21, 21), (21, 21), in the order of `CORE`.
    """
    with FILES[1].open(encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))[1:]
    by_kind = {
        kind: np.array([row[2:] for row in rows if row[0] == kind], float) for kind in ("mean", "between", "within")
    }
    return by_kind["mean"][0], by_kind["between"], by_kind["within"]


def draw_windows(generator: np.random.Generator) -> Windows:
    """Draw windows of as many infants as there are real ones: x_iw = m + b_i + e_iw, b and e Gaussian."""
    mean, between, within = real_windows()
    infants = np.repeat(np.arange(INFANTS), WINDOWS)
    offsets = generator.multivariate_normal(np.zeros(len(CORE)), between, INFANTS, check_valid="ignore")
    rest = generator.multivariate_normal(np.zeros(len(CORE)), within, len(infants), check_valid="ignore")
    return Windows(mean + offsets[infants] + rest, infants)


def accuracy_against_real(windows: Windows, generator: np.random.Generator) -> tuple[float, float]:
    """Return about how well windows are told from real infants', and the standard deviation over draws.

    The classifier of `balanced_accuracy` against infants that are drawn from the aggregates; the exact figure needs the
    recordings. `docs/movement_measures.md` says how far the two are apart.
    """
    scores = [balanced_accuracy(draw_windows(generator), windows) for _ in range(DRAWS)]
    return float(np.mean(scores)), float(np.std(scores))
