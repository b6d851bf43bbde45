"""Cost of a control step of two infants in one world, compared with that of one alone, and with two alone.

    python benchmarks/two_infants.py [--rounds 40]

All are the same child, with random commands for each control step of two physics steps of 5 ms: on its back, on a
floor, apart from each other; with proprioception and the vestibular sense, and with touch besides. Wanted: at most 2.1
times one.
"""

import argparse
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from measuring import cpu_medians_s, felt

import mimoc
from mimoc.runtime.world_env import WorldEnv

CONTROL_STEPS = 50
SENSES: dict[str, dict[str, Any]] = {"proprioception": {}, "vestibular": {}}
WITH: dict[str, dict[str, dict[str, Any]]] = {"without touch": SENSES, "with touch": {**SENSES, "touch": {}}}


def main() -> None:
    """Print one row for each set of senses."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=40)
    parser.add_argument("--age-months", type=float, default=9)
    options = parser.parse_args()
    print(f"{'senses':14} {'one [us]':>9} {'two alone [us]':>15} {'two in a world [us]':>20} {'ratio':>6}")
    for name, senses in WITH.items():
        one_us, apart_us, together_us, ratio = measure(senses, options.age_months, options.rounds)
        row = f"{one_us:9.1f} {apart_us:15.1f} {together_us:20.1f} {ratio:6.2f}"
        print(f"{name:14} {row}", flush=True)


def measure(senses: dict[str, dict[str, Any]], age_months: float, rounds: int) -> tuple[float, float, float, float]:
    """Return the CPU time of a control step of one infant, of two alone, and of two in a world, in us.

    The last number is the median of how many times that of one is that of two in a world, measured one after the other.
    """
    data = {"mimoc": 1, "name": "infant", "age_months": age_months, "senses": senses}
    spec = mimoc.InfantSpec.model_validate(data)
    bundle = mimoc.build(spec)
    env, other = mimoc.make(bundle).unwrapped, mimoc.make(bundle).unwrapped
    world = WorldEnv(mimoc.build_world({"anna": spec, "ben": spec}))
    shape = (2, CONTROL_STEPS, len(env.actuation.low))
    commands = np.random.default_rng(0).uniform(-1, 1, shape).astype(np.float32)
    candidates: dict[str, Callable[[], object]] = {
        "one": partial(felt, env, commands[0]),
        "apart": lambda: (felt(env, commands[0]), felt(other, commands[1])),
        "together": partial(lived, world, commands),
    }
    times_s = [list(cpu_medians_s(candidates, 1).values()) for _ in range(rounds)]
    one_us, apart_us, together_us = 1e6 * np.median(times_s, axis=0) / CONTROL_STEPS
    return one_us, apart_us, together_us, float(np.median([taken[2] / taken[0] for taken in times_s]))


def lived(world: WorldEnv, commands: np.ndarray) -> None:
    """Run an episode of a world."""
    world.reset(seed=0)
    for anna, ben in zip(*commands, strict=True):
        world.step({"anna": anna, "ben": ben})


if __name__ == "__main__":
    main()
