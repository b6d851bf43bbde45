"""How often the truth lies in the intervals of one camera, for motion that nothing in a fit assumes, by kind of motion.

    python benchmarks/one_camera.py [--children 3] [--first 2000] [--noise 0 1 2] [--processes 1] [--height] [--mini]
    python benchmarks/one_camera.py --calibrate --first 1000 --children 20

Children of drawn ages and sizes move by policies in physics (`moving_children.py`); one camera films them for 4 s at 25
frames/s, with noise in pixels, child by child as --noise has it, or with --every-noise each with all, and gaps of 5 %.
The fit knows the age and the hands, with --height also the camera's height. --mini sees the 14 points of MINI-RGBD.
Prints, for each kind of motion: the share of angles in their interval, of hinges that are said to be seen and of all;
the median of half the width of intervals of those that are seen; the share of hinges that are said to be unseen; and of
lengths. --calibrate prints by how much the factors in `mimoc/movement/retargeting/uncertainty.py` are too small.
"""

import argparse
import re
from collections.abc import Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from known_motions import ALL_POINTS, FloatArray, recorded
from moving_children import KINDS, RATE_HZ, moving_child
from retargeting import HEIGHT_M, average_like

import mimoc
from mimoc.bundle.model import load_model
from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.movement.retargeting.result import LEVEL, QUANTILE, Interval
from mimoc.movement.retargeting.sizes import lengths_of


@dataclass(frozen=True)
class Fit:
    """Errors of one fit, and how sure it is."""

    kind: str
    hinges: tuple[str, ...]
    off_rad: FloatArray  # Shape (t, j).
    sd_rad: FloatArray
    unseen: tuple[str, ...]
    lengths: dict[str, tuple[float, Interval]]  # True length and what the fit says, by size.


def main() -> None:
    """Print a row for each kind of motion."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--children", type=int, default=3)
    parser.add_argument("--first", type=int, default=2000)
    parser.add_argument("--seconds", type=float, default=4.0)
    parser.add_argument("--noise", type=float, nargs="*", default=[0.0, 1.0, 2.0], help="in pixels")
    parser.add_argument("--every-noise", action="store_true")
    parser.add_argument("--processes", type=int, default=1)
    parser.add_argument("--height", action="store_true", help="give the fit the camera's height")
    parser.add_argument("--mini", action="store_true")
    parser.add_argument("--calibrate", action="store_true")
    options = parser.parse_args()
    seeds = range(options.first, options.first + options.children)
    noise = options.noise
    films = [
        (kind, seed, px)
        for kind in KINDS
        for seed in seeds
        for px in (noise if options.every_noise else [noise[seed % len(noise)]])
    ]
    names = MINI_RGBD_POINTS if options.mini else ALL_POINTS
    make = partial(fitted, seconds=options.seconds, names=names, height_m=HEIGHT_M if options.height else None)
    with ProcessPoolExecutor(options.processes) as pool:
        fits = list(pool.map(make, *zip(*films, strict=True)))
    if options.calibrate:
        calibrate(fits)
        return
    print("kind of motion       seen   all  half width  unseen  lengths  half width")
    for kind in KINDS:
        print(f"{kind:18} " + row([fit for fit in fits if fit.kind == kind]))


def fitted(
    kind: str, seed: int, noise_px: float, *, seconds: float, names: tuple[str, ...], height_m: float | None
) -> Fit:
    """Return the fit to a film of one child."""
    spec, model, qpos = moving_child(kind, seed, seconds)
    draw = np.random.default_rng([seed, 99])
    film = replace(recorded(model, qpos, draw, names, rate_hz=RATE_HZ, noise_px=noise_px), depth_m=None)
    result = mimoc.retarget(film, spec.age_months, average_like(spec), camera_height_m=height_m)
    account, own, true_m = result.account, load_model(result.bundle), lengths_of(model)
    angles, truth = (
        np.stack([q[:, m.joint(name).qposadr[0]] for name in account.joints], axis=1)
        for m, q in ((own, result.qpos), (model, qpos))
    )
    lengths = {name: (true_m[name], interval) for name, interval in account.lengths_m.items()}
    return Fit(kind, account.joints, angles - truth, account.angle_sd_rad, account.unseen, lengths)


def row(fits: Sequence[Fit]) -> str:
    """Return the shares and widths of some fits."""
    inside, seen, half = [], [], []
    for fit in fits:
        inside.append(np.abs(fit.off_rad) <= QUANTILE * fit.sd_rad)
        seen.append(np.array([name not in fit.unseen for name in fit.hinges]))
        half.append(np.degrees(QUANTILE * fit.sd_rad[:, seen[-1]]).ravel())
    of_seen = np.concatenate([ok[:, is_seen].ravel() for ok, is_seen in zip(inside, seen, strict=True)])
    everything = np.concatenate([ok.ravel() for ok in inside])
    lengths = [(interval.contains(truth), interval) for fit in fits for truth, interval in fit.lengths.values()]
    holds = np.mean([contains for contains, _ in lengths])
    wide = np.median([(interval.high - interval.low) / 2 / interval.value for _, interval in lengths])
    return (
        f"{of_seen.mean():6.2f}{everything.mean():6.2f}{np.median(np.concatenate(half)):10.1f}°"
        f"{1 - np.concatenate(seen).mean():8.2f}{holds:9.2f}{wide:11.1%}"
    )


def calibrate(fits: Sequence[Fit]) -> None:
    """Print, by hinge and by length, further factors with which nine of ten intervals would hold, kind by kind."""
    ratios: dict[str, dict[str, list[FloatArray]]] = {}
    for fit in fits:
        over = np.abs(fit.off_rad) / fit.sd_rad
        for name, column in zip(fit.hinges, over.T, strict=True):
            part = re.sub(r"^robot:(left_|right_)?|(?<=hip_\w{3})\d$|(?<=_lean)\d$|(?<=_bend)\d$", "", name)
            ratios.setdefault(part, {}).setdefault(fit.kind, []).append(column)
        for name, (truth, interval) in fit.lengths.items():
            sd = np.log(interval.high / interval.low) / 2
            off = np.abs(np.log(truth / interval.value))
            ratios.setdefault(f"length of {name}", {}).setdefault(fit.kind, []).append(np.array([off / sd * QUANTILE]))
    print(f"{'':24}" + "".join(f"{kind:>18}" for kind in KINDS))
    for part, by_kind in sorted(ratios.items()):
        values = [np.quantile(np.concatenate(by_kind[kind]), LEVEL) / QUANTILE for kind in KINDS]
        print(f"{part:24}" + "".join(f"{value:18.2f}" for value in values))


if __name__ == "__main__":
    main()
