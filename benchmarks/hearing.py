"""Cost of hearing: a control step of an infant with eyes that hears, compared with the same infant that does not.

    python benchmarks/hearing.py [--rounds 30]

Both make the same movements, in turns of 25 control steps, and the median of the ratio of CPU times counts. Wanted: at
most 1.10 with two eyes of 64 x 64 pixels; without the sense, nothing is done (1.00 of an infant of before).
"""

import argparse
import os
import statistics
import time

os.environ.setdefault("MUJOCO_GL", "egl")

import numpy as np

import mimoc
from mimoc.policies.named import policy_of

SCENES = {
    "on the floor, general movements": ("general_movements", {"kind": "flat"}),
    "among six toys, random commands": ("random", {"kind": "room", "toys": {"count": [6, 6]}}),
}
OUTPUTS = ("cochleagram", "waveform")
TURN = 25


def main() -> None:
    """Print a row for each scene, output, and infant with and without eyes."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=30)
    rounds = parser.parse_args().rounds
    print(f"{'scene':34}{'senses':10}{'output':12}{'without [us]':>13}{'with [us]':>11}{'ratio':>7}")
    for name, (policy, scene) in SCENES.items():
        for has_eyes in (True, False):
            for output in OUTPUTS:
                without_us, with_us, ratio = compare(policy, scene, has_eyes, output, rounds)
                numbers = f"{without_us:13.0f}{with_us:11.0f}{ratio:7.3f}"
                print(f"{name:34}{'eyes' if has_eyes else 'no eyes':10}{output:12}{numbers}", flush=True)


def compare(policy: str, scene: dict, has_eyes: bool, output: str, rounds: int) -> tuple[float, float, float]:
    """Return the median CPU time of a control step without and with hearing, and the median of their ratio."""
    senses = {"proprioception": {}, "vestibular": {}, **({"vision": {}} if has_eyes else {})}
    envs = [opened(scene, hears) for hears in (senses, {**senses, "hearing": {"output": output}})]
    acts = [policy_of(env, policy) for env in envs]
    chances = [np.random.default_rng(0) for _ in envs]
    observations = [env.reset(seed=0)[0] for env in envs]
    times_us: list[list[float]] = [[], []]
    for _ in range(rounds + 1):
        for index, (env, act, chance) in enumerate(zip(envs, acts, chances, strict=True)):
            taken = 0.0
            for _ in range(TURN):
                action = act(chance, observations[index])
                start = time.process_time()
                observations[index] = env.step(action)[0]
                taken += time.process_time() - start
            times_us[index].append(1e6 * taken / TURN)
    without_us, with_us = (turns[1:] for turns in times_us)
    ratio = statistics.median(after / before for before, after in zip(without_us, with_us, strict=True))
    return statistics.median(without_us), statistics.median(with_us), ratio


def opened(scene: dict, senses: dict) -> mimoc.InfantEnv:
    """Return the environment of an infant of six months."""
    spec = {"mimoc": 1, "name": "x", "age_months": 6, "senses": senses, "scene": scene}
    return mimoc.make(mimoc.InfantSpec.model_validate(spec)).unwrapped


if __name__ == "__main__":
    main()
