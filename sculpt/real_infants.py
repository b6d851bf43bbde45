"""Make the aggregates of real infants that mimoc contains, from the user's own copy of MINI-RGBD's keypoints.

    python sculpt/real_infants.py RECORDING ...

The recordings, of one infant each, are in any format that mimoc reads. Only means, standard deviations and covariances
over all of them are written.
"""

import csv
import sys
from pathlib import Path

import numpy as np

from mimoc.base.movement_quantities import CORE
from mimoc.motion.reading import read_points
from mimoc.movement.measured import measure_movement
from mimoc.movement.sample import FILES, windows_of


def main(paths: list[Path]) -> None:
    """Write both files."""
    recordings = [read_points(path) for path in paths]
    measures = [measure_movement(recording) for recording in recordings]
    names = [name for name in measures[0] if all(name in one for one in measures)]
    rows = [(name, *_mean_and_deviation([one[name] for one in measures])) for name in names]
    _write(FILES[0], [("measure", "mean", "sd"), *rows])
    windows = windows_of(recordings)
    groups = [windows.values[windows.infants == infant] for infant in range(len(recordings))]
    within = sum(np.cov(group.T) for group in groups) / len(groups)
    means = np.array([group.mean(axis=0) for group in groups])
    between = np.cov(means.T) - within / len(groups[0])
    values, vectors = np.linalg.eigh(between)
    between = (vectors * np.maximum(values, 0)) @ vectors.T  # The difference of two estimates may have negative ones.
    core = [quantity.name for quantity in CORE]
    kinds = (("mean", means.mean(axis=0)[None]), ("between", between), ("within", within))
    rows = [
        (kind, name, *(f"{value:.6g}" for value in row))
        for kind, matrix in kinds
        for name, row in zip(core if len(matrix) > 1 else [""], matrix, strict=True)
    ]
    _write(FILES[1], [("kind", "measure", *core), *rows])


def _mean_and_deviation(values: list[float]) -> tuple[str, str]:
    return f"{np.mean(values):.6g}", f"{np.std(values, ddof=1):.6g}"


def _write(path: Path, rows: list[tuple[str, ...]]) -> None:
    with path.open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows(rows)


if __name__ == "__main__":
    main([Path(argument) for argument in sys.argv[1:]])
