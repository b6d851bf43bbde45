"""Reading recordings of points (stands in until the readers of all formats are merged)."""

import csv
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.errors import MimocError
from mimoc.motion.point_recording import PointRecording


def read_points(path: str | Path, **options: Any) -> PointRecording:
    """Return the points in an NPZ (`positions`, `names`, `rate_hz`) or a CSV of cells `x,y`."""
    path = Path(path)
    if path.suffix == ".npz":
        with np.load(path) as arrays:
            positions, names = arrays["positions"], tuple(map(str, arrays["names"]))
            rate_hz = float(arrays["rate_hz"])
    elif path.suffix == ".csv":
        header, *rows = csv.reader(path.read_text().splitlines(), delimiter=";")
        positions = np.array([[cell.split(",") for cell in row[1:]] for row in rows], float)
        names, rate_hz = tuple(header[1:]), float(options.get("rate_hz") or 30.0)
    else:
        raise MimocError(f"{path}: not a recording of points")
    confidence = np.isfinite(positions).all(axis=-1).astype(float)
    return PointRecording(path.stem, rate_hz, names, positions, confidence)
