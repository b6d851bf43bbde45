"""Mean error of joints in space on MINI-RGBD (Hesse et al. 2018), whose folder you have; it may not be passed on.

    python benchmarks/mini_rgbd.py FOLDER [--sequences 01 02 ...] [--frames 1000] [--age 3] [--depth]

FOLDER has the sequences 01 to 12, each with `joints_2Ddep` and `joints_3D`. Each is fitted from its pixels alone or,
with --depth, from pixels and depth. Joints in space are compared in the frame of the camera: as they are; with the
middle of the hips where it is in truth; and turned, moved and scaled onto the truth in each frame (Procrustes). Prints
means over joints and frames, in mm, of each sequence and over all. The joints of mimoc's body are not exactly at those
of the data set's.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import numpy as np
from known_motions import FloatArray

import mimoc
from mimoc.bundle.model import load_model
from mimoc.motion.body_points import locate
from mimoc.motion.read_mini_rgbd import JOINTS, POINTS
from mimoc.movement.retargeting.observations import camera_from_world

MAX_M = 20.0  # Distances from the camera above are in millimetres.
WAYS = "as it is", "hips aligned", "Procrustes"


def main() -> None:
    """Print a line for each sequence, and the means over all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--sequences", nargs="*", help="default: all")
    parser.add_argument("--frames", type=int, default=1000)
    parser.add_argument("--age", type=float, default=3.0, help="in months, which the data set does not say")
    parser.add_argument("--depth", action="store_true", help="use depth, too")
    options = parser.parse_args()
    folders = sorted(path.parent for path in options.folder.glob("*/joints_2Ddep"))
    folders = [path for path in folders if not options.sequences or path.name in options.sequences]
    if not folders:
        parser.error(f"{options.folder}: there are no sequences here, such as 01/joints_2Ddep")
    print(f"{'sequence':10}" + "".join(f"{way:>15}" for way in WAYS) + "  [mm]")
    rows = []
    for folder in folders:
        rows.append(1000 * errors_m(folder, options.age, options.frames, options.depth))
        print(f"{folder.name:10}" + "".join(f"{value:15.1f}" for value in rows[-1]), flush=True)
    print(f"{'mean':10}" + "".join(f"{value:15.1f}" for value in np.mean(rows, axis=0)))


def errors_m(sequence: Path, age_months: float, frames: int, with_depth: bool) -> FloatArray:
    """Return the mean errors of a sequence in the three ways, [m]."""
    recording = mimoc.read_points(sequence / "joints_2Ddep").window(0, frames)
    truth_m = joints_m(sequence / "joints_3D", frames)[: recording.frames]
    result = mimoc.retarget(recording if with_depth else replace(recording, depth_m=None), age_months)
    names = [name for name in result.recording.names if name in POINTS]
    truth_m = truth_m[:, [JOINTS.index(POINTS[name]) for name in names]]
    fitted_m = locate(load_model(result.bundle), result.qpos, names) - [0.0, 0.0, result.camera_height_m]
    fitted_m = fitted_m @ camera_from_world(result.account.camera_pitch_deg.value).T
    known = np.isfinite(fitted_m).all((0, 2))
    fitted_m, truth_m = fitted_m[:, known], truth_m[:, known]
    names = [name for name, is_known in zip(names, known, strict=True) if is_known]
    whole = np.isfinite(truth_m).all((1, 2))
    return np.array([np.nanmean(value) for value in distances_m(fitted_m[whole], truth_m[whole], names)])


def distances_m(fitted_m: FloatArray, truth_m: FloatArray, names: list[str]) -> list[FloatArray]:
    """Return distances of points, shape (t, k) each: as they are, with hips aligned, and after Procrustes."""
    hips = [names.index("left_hip"), names.index("right_hip")]
    apart = fitted_m - truth_m
    moved = apart - apart[:, hips].mean(axis=1, keepdims=True)
    laid = np.array([procrustes(a, b) - b for a, b in zip(fitted_m, truth_m, strict=True)])
    return [np.linalg.norm(value, axis=-1) for value in (apart, moved, laid)]


def procrustes(points: FloatArray, onto: FloatArray) -> FloatArray:
    """Return points turned, moved and scaled so that they are as near to others as can be; shape (k, 3) each."""
    a, b = points - points.mean(axis=0), onto - onto.mean(axis=0)
    left, sizes, right = np.linalg.svd(a.T @ b)
    signs = np.array([1.0, 1.0, np.sign(np.linalg.det(left @ right))])
    return (sizes * signs).sum() / (a**2).sum() * a @ (left * signs) @ right + onto.mean(axis=0)


def joints_m(folder: Path, frames: int) -> FloatArray:
    """Return joints in the frame of the camera, shape (t, 25, 3), from files of lines `x y z joint`."""
    paths = sorted(folder.glob("syn_joints_3D_*.txt"))[:frames]
    result = np.full((len(paths), len(JOINTS), 3), np.nan)
    for places, path in zip(result, paths, strict=True):
        rows = np.loadtxt(path, ndmin=2)
        places[rows[:, 3].astype(int)] = rows[:, :3]
    return result / 1000 if np.nanmedian(result[..., 2]) > MAX_M else result


if __name__ == "__main__":
    main()
