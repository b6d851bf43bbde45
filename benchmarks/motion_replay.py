"""How well infants who were filmed are replayed on their own bodies, by their own strength: figures over recordings.

    python benchmarks/motion_replay.py RECORDING... --rate 30 --seconds 10 --actuation muscle

Prints the median over the recordings, and their range, of what `mimoc run OUT --policy motion` reports. Nothing of a
single recording is printed or kept.
"""

import argparse
from collections.abc import Iterator
from pathlib import Path

import numpy as np

import mimoc
from mimoc.bundle.model import load_model
from mimoc.motion.joint_motion import motion_of
from mimoc.movement.retargeting.folder import altered
from mimoc.policies.motion import MotionPolicy
from mimoc.policies.rollout import Run


def main() -> None:
    """Replay some recordings, freely and assisted."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("recordings", nargs="+", type=Path)
    parser.add_argument("--rate", type=float, default=None)
    parser.add_argument("--seconds", type=float, default=10.0)
    parser.add_argument("--age", type=float, default=3.0)
    parser.add_argument("--actuation", default="torque")
    arguments = parser.parse_args()
    figures: dict[str, list[float]] = {}
    for path in arguments.recordings:
        for name, value in measured(path, arguments):
            figures.setdefault(name, []).append(value)
    print(f"{len(arguments.recordings)} recordings, {arguments.seconds:g} s each, {arguments.actuation}")
    for name, values in figures.items():
        print(f"{name:42} {np.median(values):10.3g} ({min(values):.3g} to {max(values):.3g})")


def measured(path: Path, arguments: argparse.Namespace) -> Iterator[tuple[str, float]]:
    """Yield the figures of a recording by name."""
    points = mimoc.read_points(path, rate_hz=arguments.rate)
    points = points.window(0, round(arguments.seconds * points.rate_hz) + 1)
    result = altered(mimoc.retarget(points, arguments.age), None, arguments.actuation)
    yield "reprojection_error_of_trunk", result.account.error_share
    root_body = result.bundle.manifest.root_body
    motion = motion_of(load_model(result.bundle), root_body, result.qpos, result.rate_hz)
    for root in ("free", "assisted"):
        env = mimoc.InfantEnv(result.bundle)
        policy = MotionPolicy(env, motion, root)
        run = Run(env, lambda env, policy=policy: policy, seed=0)
        for _ in range(policy.whole_steps):
            run.step()
        for name, value in run.summary().metrics.items():
            yield f"{root}: {name}", value


if __name__ == "__main__":
    main()
