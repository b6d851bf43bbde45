"""How long reading points on a filmed infant takes: CPU time of one core, per format, with all checks.

    python benchmarks/motion_reading.py [--minutes 10] [--rounds 3]

A simulated infant kicks; files as pose estimators, MINI-RGBD and motion capture write them are read back.
"""

import argparse
import os
import sys
import tempfile
import time
from dataclasses import replace
from pathlib import Path
from statistics import median

import numpy as np

import mimoc

sys.path.append(str(Path(__file__).parents[1] / "tests"))
from support import filmed

from mimoc.motion.body_points import film
from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.motion.point_recording import PointRecording
from mimoc.motion.reading import write_points

RATE_HZ = 30


def main() -> None:
    """Print a line for each format."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--minutes", type=float, default=10.0)
    parser.add_argument("--rounds", type=int, default=3)
    options = parser.parse_args()
    frames = round(60 * RATE_HZ * options.minutes)
    print(f"{frames:,} frames; median of {options.rounds} rounds, CPU time")
    with tempfile.TemporaryDirectory() as folder:
        for name, path in written(Path(folder), frames).items():
            spent = [seconds(path) for _ in range(options.rounds)]
            files = len(os.listdir(path)) if path.is_dir() else 1
            print(f"{name:34} {files:7,} files  {median(spent):6.2f} s")


def written(folder: Path, frames: int) -> dict[str, Path]:
    """Return files of the same infant in each format."""
    seen = filmed.filmed(frames, filmed.BODY_25_POINTS)
    gaps = np.random.default_rng(0).random(seen.confidence.shape) < 0.05
    seen = replace(seen, positions=np.where(gaps[..., None], np.nan, seen.positions), confidence=1.0 - gaps)
    fourteen = filmed.filmed(frames)
    return {
        "OpenPose, BODY_25, JSON folder": filmed.write_openpose(seen, folder / "openpose"),
        "OpenPose, two persons": filmed.write_openpose(seen, folder / "two", (shrunk(seen),)),
        "COCO-17, JSON folder": filmed.write_coco(seen, folder / "coco"),
        "COCO-17, one file": filmed.write_coco(seen, folder / "coco.json"),
        "MINI-RGBD, 2D and depth, 14 points": filmed.write_mini_rgbd(deep(frames), folder / "mini") / "joints_2Ddep",
        "CSV, 25 points": write_points(seen, folder / "points.csv"),
        "CSV of pairs, 14 points": filmed.write_pairs(fourteen, folder / "pairs.csv"),
        "NPZ, 25 points": write_points(seen, folder / "points.npz"),
        "C3D, 14 markers": filmed.write_c3d(filmed.in_space(frames), folder / "markers.c3d"),
    }


def deep(frames: int) -> PointRecording:
    """Return pixels with depth."""
    return film(filmed.kicking_model(), filmed.kicking(frames), RATE_HZ, MINI_RGBD_POINTS)


def shrunk(recording: PointRecording) -> PointRecording:
    """Return a smaller person beside it."""
    return replace(recording, positions=recording.positions / 2 + 300)


def seconds(path: Path) -> float:
    """Return how long reading takes."""
    start = time.process_time()
    mimoc.read_points(path, rate_hz=RATE_HZ)
    return time.process_time() - start


if __name__ == "__main__":
    main()
