"""How near the figure from aggregates of real infants is to the exact one, for policies and for noise of many kinds.

    python benchmarks/movement_told_apart.py RECORDINGS [--policies general_movements random] [--seeds 0:12]

RECORDINGS is a folder with the user's own copy of the keypoints of MINI-RGBD, an infant a file or folder. For each
policy and for low-pass noise in bursts: the distance of its mean to the real infants, and how well windows of 8 s are
told from theirs, exactly and from the aggregates that mimoc has. Then the floor: how well six of the infants are told
from the other six, over all ways to divide them.
"""

import argparse
from collections.abc import Iterator, Sequence
from itertools import combinations
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.movement.filming import film_policy, films_in
from mimoc.movement.measures import core_measures
from mimoc.movement.sample import Windows, accuracy_against_real, balanced_accuracy, distance, real_infants, windows_of
from mimoc.policies.policy import Policy, PolicyMaker
from mimoc.runtime.env import InfantEnv
from mimoc.schema.infant import InfantSpec

NOISES = ((0.05, 0.3, 0.0), (0.15, 0.3, 0.0), (0.3, 0.3, 0.0), (0.15, 0.2, 0.8), (0.3, 0.4, 0.8), (0.2, 0.3, 1.3))
"""Time constant [s], amplitude [range], and depth of bursts of noise on the muscles."""
BURST_S = 1.5  # Time constant of bursts.


def main() -> None:
    """Print a line for each."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("recordings", type=Path)
    parser.add_argument("--policies", nargs="*", default=["general_movements", "random"])
    parser.add_argument("--seeds", default="0:12")
    options = parser.parse_args()
    seeds, real = range(*map(int, options.seeds.split(":"))), [film.seen for film in films_in(options.recordings)]
    windows, apart = windows_of(real), []
    print(f"{'':24}{'distance':>9}{'exact':>8}{'aggregates':>12}")
    for name, policy in _policies(options.policies):
        seen = [film.seen for film in film_policy(_three_months(), policy, seeds)]
        measures = [core_measures(recording) for recording in seen]
        mean = {key: float(np.mean([one[key] for one in measures])) for key in measures[0]}
        exact = balanced_accuracy(windows, windows_of(seen))
        about, _ = accuracy_against_real(windows_of(seen), np.random.default_rng(0))
        apart.append(about - exact)
        print(f"{name:24}{distance(mean, real_infants()):9.2f}{exact:8.2f}{about:12.2f}", flush=True)
    print(f"aggregates less exact: mean {np.mean(apart):+.3f}, RMS {np.sqrt(np.mean(np.square(apart))):.3f}")
    floors = [*_halves(windows)]
    print(f"half of the infants from the other: {np.mean(floors):.2f} ± {np.std(floors):.2f}, {len(floors)} ways")


def _policies(names: Sequence[str]) -> Iterator[tuple[str, str | PolicyMaker]]:
    yield from ((name, name) for name in names)
    for numbers in NOISES:
        yield "noise {:g} s, {:g}, {:g}".format(*numbers), _noise(*numbers)


def _noise(time_s: float, amplitude: float, depth: float) -> PolicyMaker:
    """Return what commands the positive part of low-pass noise, times exp(depth x slower noise)."""

    def bind(env: InfantEnv) -> Policy:
        space: Any = env.action_space
        low, high = space.low, space.high
        state, burst = np.zeros(len(low)), np.zeros(1)
        step_s = env.manifest.step_ms / 1000

        def act(generator: np.random.Generator, observation: object) -> np.ndarray:
            for values, constant_s in ((state, time_s), (burst, BURST_S)):
                kept = np.exp(-step_s / constant_s)
                values[:] = kept * values + np.sqrt(1 - kept**2) * generator.standard_normal(len(values))
            drive = amplitude * np.exp(depth * burst) * np.maximum(state - 0.3, 0) * (high - low)
            return np.clip(np.clip(0, low, high) + drive, low, high).astype(np.float32)

        return act

    return bind


def _three_months() -> InfantSpec:
    scene = {"kind": "flat", "pose": "supine"}
    return InfantSpec.model_validate(
        {"mimoc": 1, "name": "three", "age_months": 3, "actuation": {"model": "muscle"}, "scene": scene}
    )


def _halves(windows: Windows) -> Iterator[float]:
    """Yield how well one half of the infants is told from the other, for each way to divide them."""
    infants = np.unique(windows.infants)
    for others in combinations(infants[1:], len(infants) // 2 - 1):
        is_first = np.isin(windows.infants, (infants[0], *others))
        groups = [Windows(windows.values[part], windows.infants[part]) for part in (is_first, ~is_first)]
        yield balanced_accuracy(*groups)


if __name__ == "__main__":
    main()
