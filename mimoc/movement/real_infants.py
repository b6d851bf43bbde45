"""Twelve real infants, as aggregates only: means and deviations of their measures, and of windows of 8 s.

MINI-RGBD (Hesse et al. 2018, ECCV workshops): supine, awake, up to 7 months old, 33 s each, at 30 frames/s as was
assumed. Four of the twelve are labelled as lacking normal fidgety movements. `sculpt/real_infants.py` made the files
from keypoints, which mimoc neither contains nor downloads.
"""

import csv
from functools import cache
from pathlib import Path

import numpy as np

from mimoc.base.quantities.movement import CORE
from mimoc.motion.point_recording import FloatArray
from mimoc.movement.classifier import Windows, told_apart
from mimoc.movement.sample import Sample

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


def told_from_real(windows: Windows, generator: np.random.Generator) -> tuple[float, float]:
    """Return about how well windows are told from real infants', and the standard deviation over draws.

    The classifier of `told_apart` against infants that are drawn from the aggregates; the exact figure needs the
    recordings. `docs/movement_measures.md` says how far the two are apart.
    """
    scores = [told_apart(draw_windows(generator), windows) for _ in range(DRAWS)]
    return float(np.mean(scores)), float(np.std(scores))
