"""Known motions of random children, filmed and fitted: errors, intervals and speed, against what was asked for.

python benchmarks/retargeting.py [--children 20] [--first 0] [--points all|mini] [--kind pixels|depth|space] [--height]
"""

import argparse
import json
from typing import Any

import mujoco
import numpy as np
from known_motions import ALL_POINTS, in_space, known_motion, model_of, random_child, recorded

import mimoc
from mimoc.bundle.model import load_model
from mimoc.motion.body_points import locate
from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.movement.retargeting.result import QUANTILE, Retargeted
from mimoc.movement.retargeting.sizes import lengths_of
from mimoc.schema.body import BodySpec

HEIGHT_M = 1.08
WELL_DEG = 10.0  # Hinges whose own standard deviation is below it count as well determined.


def main() -> None:
    """Print a row for each kind of recording."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--children", type=int, default=4)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--kind", choices=["pixels", "depth", "space"], nargs="*", default=["pixels", "depth", "space"])
    parser.add_argument("--points", choices=["mini", "all"], default="all")
    parser.add_argument("--height", action="store_true", help="give the fit the camera's height")
    parser.add_argument("--each", action="store_true")
    options = parser.parse_args()
    names = ALL_POINTS if options.points == "all" else MINI_RGBD_POINTS
    for kind in options.kind:
        rows = []
        for seed in range(options.first, options.first + options.children):
            rows.append(checked(kind, seed, options.seconds, names, HEIGHT_M if options.height else None))
            if options.each:
                print(seed, {key: shown(value) for key, value in rows[-1].items() if key != "angles"}, flush=True)
        print(kind, json.dumps(summary(rows)))


def shown(value: Any) -> Any:
    """Return a number to three digits."""
    return float(f"{value:.3g}") if isinstance(value, float) else value


def checked(
    kind: str, seed: int, seconds: float, names: tuple[str, ...] = ALL_POINTS, height_m: float | None = None
) -> dict[str, Any]:
    """Return the figures of one child."""
    draw = np.random.default_rng(seed)
    spec = random_child(draw)
    model = model_of(spec)
    qpos = known_motion(model, draw, round(30 * seconds), 30.0)
    if kind == "space":
        recording = in_space(model, qpos, draw, names=names)
    else:
        recording = recorded(model, qpos, draw, names, depth_noise_m=0.01 if kind == "depth" else None)
    result = mimoc.retarget(recording, spec.age_months, average_like(spec), camera_height_m=height_m)
    return {"age_months": spec.age_months, **figures(model, qpos, result)}


def average_like(spec: mimoc.InfantSpec) -> mimoc.InfantSpec:
    """Return the average child of an age with the hands of another."""
    return mimoc.InfantSpec(
        mimoc=1,
        name="fitted",
        age_months=spec.age_months,
        body=BodySpec(hands=spec.body.hands),
        senses=spec.senses,
        scene=spec.scene,
    )


def figures(model: mujoco.MjModel, qpos: np.ndarray, result: Retargeted) -> dict[str, Any]:
    """Return errors of a fit to a known motion, and whether truth lies in the intervals."""
    account, fitted = result.account, load_model(result.bundle)
    names = result.recording.names
    apart = np.linalg.norm(locate(model, qpos, names) - locate(fitted, result.qpos, names), axis=-1)
    truth, lengths = lengths_of(model), account.lengths_m
    angles = {}
    for index, name in enumerate(account.joints):
        off = result.qpos[:, fitted.joint(name).qposadr[0]] - qpos[:, model.joint(name).qposadr[0]]
        sd = account.angle_sd_rad[:, index]
        angles[name.removeprefix("robot:").removeprefix("left_").removeprefix("right_")] = (off, sd)
    ranges = fitted.jnt_range[1:]
    hinges = result.qpos[:, fitted.jnt_qposadr[1:]]
    height = account.camera_height_m
    return {
        "of_trunk": account.error_share,
        "joints_m": float(np.nanmedian(apart)),
        "proportion_error": {
            n: abs(interval.value / truth[n] / (lengths["trunk"].value / truth["trunk"]) - 1)
            for n, interval in lengths.items()
            if n in truth
        },
        "length_error": {n: abs(interval.value / truth[n] - 1) for n, interval in lengths.items() if n in truth},
        "length_inside": [interval.contains(truth[n]) for n, interval in lengths.items() if n in truth],
        "height_inside": None if height is None else height.contains(HEIGHT_M),
        "height_off": None if height is None else height.value / HEIGHT_M - 1,
        "beyond_limits_rad": float(np.maximum(ranges[:, 0] - hinges, hinges - ranges[:, 1]).max()),
        "frames_per_s": account.frames_per_s,
        "noise": account.noise,
        "angles": angles,
    }


GROUPS = ("shoulder", "elbow", "hand", "hip_", "hip", "knee", "foot", "head")
"""Parts of names of hinges; a hinge belongs to the first that its name contains (`hip_` are the lumbar hinges)."""


def errors_over_sd(rows: list[dict[str, Any]]) -> dict[str, list[float]]:
    """Return the median and the 90th percentile of errors over their SD, by group of hinges; normal: .67 and 1.64."""
    result: dict[str, list[np.ndarray]] = {}
    for name, (off, sd) in (item for row in rows for item in row["angles"].items()):
        group = next(part for part in GROUPS if part in name)
        result.setdefault(group, []).append(np.abs(off) / sd)
    return {
        group: [round(float(np.quantile(np.concatenate(parts), level)), 2) for level in (0.5, 0.9)]
        for group, parts in result.items()
    }


def summary(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """Return medians and shares over children."""
    hinges = sorted({name for row in rows for name in row["angles"]})
    by_hinge, inside, off_well = {}, [], []
    for name in hinges:
        off, sd = (np.concatenate([row["angles"][name][i] for row in rows if name in row["angles"]]) for i in (0, 1))
        covered = np.abs(off) < QUANTILE * sd
        by_hinge[name] = [
            round(float(np.degrees(np.median(np.abs(off)))), 1),
            round(float(np.degrees(np.median(sd))), 1),
        ]
        by_hinge[name].append(round(float(covered.mean()), 2))
        inside.append(covered)
        off_well.append(np.abs(off)[sd < np.radians(WELL_DEG)])
    sizes = sorted({name for row in rows for name in row["length_error"]})
    heights = [row["height_inside"] for row in rows if row["height_inside"] is not None]
    return {
        "of_trunk": shown(float(np.median([row["of_trunk"] for row in rows]))),
        "of_trunk_worst": shown(float(np.max([row["of_trunk"] for row in rows]))),
        "joints_m": shown(float(np.median([row["joints_m"] for row in rows]))),
        "joints_m_worst": shown(float(np.max([row["joints_m"] for row in rows]))),
        "angles_well_deg": shown(float(np.degrees(np.median(np.concatenate(off_well))))),
        "angles_inside": shown(float(np.concatenate(inside).mean())),
        "lengths_error_median": {
            n: shown(float(np.median([row["length_error"][n] for row in rows if n in row["length_error"]])))
            for n in sizes
        },
        "proportions_error_median": {
            n: shown(float(np.median([row["proportion_error"][n] for row in rows if n in row["proportion_error"]])))
            for n in sizes
        },
        "lengths_inside": shown(float(np.mean(np.concatenate([row["length_inside"] for row in rows])))),
        "height_inside": shown(float(np.mean(heights))) if heights else None,
        "beyond_limits_rad": shown(float(np.max([row["beyond_limits_rad"] for row in rows]))),
        "frames_per_s": [shown(float(f([row["frames_per_s"] for row in rows]))) for f in (np.min, np.median)],
        "errors_over_sd_median_p90": errors_over_sd(rows),
        "hinges_deg_sd_inside": by_hinge,
    }


if __name__ == "__main__":
    main()
