"""Whether a classifier can tell two groups of infants apart by windows of their movement."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MovementError
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.movement.measures import core_measures

IntArray = npt.NDArray[np.integer]
BoolArray = npt.NDArray[np.bool_]
WINDOW_S = 8.0
SHRINKAGE = 0.5  # Share of the covariance that is shrunk to its diagonal.
RIDGE = 0.05  # Added to the variances of the standardised measures.
LARGEST_SCORE = 4.0  # Standardised measures are clipped at it.


@dataclass(frozen=True)
class Windows:
    """The 21 measures of windows of 8 s of some infants."""

    values: FloatArray  # Shape (w, 21), in the order of `mimoc.base.quantities.movement.CORE`.
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


def told_apart(first: Windows, second: Windows) -> float:
    """Return the balanced accuracy at which windows of two groups of infants are told apart; .5 is chance.

    Each infant in turn is left out, and its windows are classified by all others. A value below .5 says that an
    infant differs more from the others of its group than the groups from each other.

    Raises:
        MovementError: If a group is too small: it must have two windows when an infant is left out.
    """
    return float(np.mean([right.mean() for right in _recognised(first, second)]))


def told_apart_error(first: Windows, second: Windows) -> float:
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
    known, new = (np.clip((rows - mean) / deviation, -LARGEST_SCORE, LARGEST_SCORE) for rows in (values, unknown))
    groups = [known[labels == label] for label in (False, True)]
    within = sum(np.cov(group.T) for group in groups) / 2
    shrunk = (1 - SHRINKAGE) * within + np.diag(SHRINKAGE * np.diag(within) + RIDGE)
    means = [group.mean(axis=0) for group in groups]
    direction = np.linalg.solve(shrunk, means[1] - means[0])
    return new @ direction > (means[0] + means[1]) @ direction / 2
