"""Cost of a control step by actuation model and hands, compared with the same physics in a bare loop.

    python benchmarks/actuation.py [--rounds 40]

As in `step.py`: proprioception and balance are felt, both go through the same states, in alternating rounds, and the
median CPU time counts. The bare loop sets the same controls and calls `mujoco.mj_step` twice. Wanted: at most 1.3.
"""

import argparse
from functools import partial

import mujoco
import numpy as np
from measuring import cpu_medians_s, felt
from step import CONTROL_STEPS, bare

import mimoc

MODELS = ("torque", "muscle", "position")
SENSES = {"proprioception": {}, "vestibular": {}}


def main() -> None:
    """Print one row for each model and kind of hands."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=40)
    parser.add_argument("--age-months", type=float, default=9)
    options = parser.parse_args()
    print(f"{'hands':12} {'model':9} {'numbers':>8} {'mimoc [us]':>11} {'bare [us]':>10} {'ratio':>6}")
    for hands in ("mitten", "five_finger"):
        for model in MODELS:
            numbers, mimoc_us, bare_us = measure(hands, model, options.age_months, options.rounds)
            ratio = mimoc_us / bare_us
            print(f"{hands:12} {model:9} {numbers:8} {mimoc_us:11.1f} {bare_us:10.1f} {ratio:6.2f}", flush=True)


def measure(hands: str, model: str, age_months: float, rounds: int) -> tuple[int, float, float]:
    """Return how many numbers are felt, and the CPU time of a control step in mimoc and in a bare loop, in µs."""
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "senses": SENSES}
    spec |= {"body": {"hands": hands}, "actuation": {"model": model}}
    env = mimoc.make(mimoc.build(mimoc.InfantSpec.model_validate(spec)))
    low, high = env.action_space.low, env.action_space.high
    commands = np.random.default_rng(0).uniform(low, high, (CONTROL_STEPS, *low.shape)).astype(np.float32)
    compiled = env.unwrapped.model
    data, start = mujoco.MjData(compiled), compiled.key(env.unwrapped.manifest.pose).id
    candidates = {"mimoc": partial(felt, env, commands), "bare": partial(bare, compiled, data, start, commands)}
    step_us = {name: 1e6 * taken_s / CONTROL_STEPS for name, taken_s in cpu_medians_s(candidates, rounds).items()}
    if not np.array_equal(env.unwrapped.data.qpos, data.qpos):
        raise SystemExit("the two did not go through the same states")
    return env.observation_space["proprioception"].shape[0], step_us["mimoc"], step_us["bare"]


if __name__ == "__main__":
    main()
