"""Cost of touch: alone, compared with a plain loop over contacts, and in a control step, compared with bare physics.

    python benchmarks/touch.py [--rounds 40]

The loop is the one that the tests hold the sense to: contact by contact, all points of the skin. Both feel the same
states of an infant that moves at random. A control step is two physics steps of 5 ms, with proprioception and balance,
and with touch too; it goes through the same states as a bare loop of `mujoco.mj_step`. All alternate, and the median
CPU time counts. Wanted: at least 3 times the speed of the loop; with all three senses at least 0.5 of the rate of the
bare loop, and 0.65 with five fingers.
"""

import argparse
import copy
import sys
from functools import partial
from pathlib import Path

import mujoco
import numpy as np
from measuring import cpu_medians_s, felt
from step import CONTROL_STEPS, bare

import mimoc
from mimoc.components.senses.touch.run import bind

sys.path.append(str(Path(__file__).parents[1] / "tests"))
from support.touch_oracle import touch_loop

POSES = ("supine", "prone", "sitting", "standing")
SENSES = {"proprioception": {}, "vestibular": {}}


def main() -> None:
    """Print one row for each kind of hands and pose."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=40)
    parser.add_argument("--age-months", type=float, default=9)
    options = parser.parse_args()
    print(f"{'':39}{'touch alone [us]':>27}{'control step [us]':>27}{'rate / bare':>18}")
    columns = ("points", "contacts", "ours", "loop", "times", "bare", "without", "with", "without", "with")
    print(f"{'hands':12}{'pose':9}" + "".join(f"{column:>9}" for column in columns))
    for hands in ("mitten", "five_finger"):
        for pose in POSES:
            points, *alone = measure_alone(hands, pose, options.age_months, options.rounds)
            times_us, rates = measure_steps(hands, pose, options.age_months, options.rounds)
            numbers = "".join(f"{number:9.1f}" for number in (*alone, *times_us))
            print(f"{hands:12}{pose:9}{points:9.0f}{numbers}" + "".join(f"{rate:9.2f}" for rate in rates), flush=True)


def measure_alone(hands: str, pose: str, age_months: float, rounds: int) -> tuple[float, ...]:
    """Return how many points and contacts there are, the CPU time of touch and of the loop in µs, and their ratio."""
    env = open_infant(hands, pose, age_months, {"touch": {}})
    model, entry = env.unwrapped.model, env.unwrapped.manifest.senses.touch
    states = []
    env.reset(seed=0)
    for command in random_commands(env):
        env.step(command)
        states.append(copy.copy(env.unwrapped.data))
    senses = {"touch": bind(entry, model, env.unwrapped.bundle), "loop": touch_loop(entry, env.unwrapped.bundle, model)}
    if not all(np.allclose(senses["touch"](state), senses["loop"](state)) for state in states):
        raise SystemExit("touch and the loop did not feel the same")
    candidates = {name: partial(feel_all, sense, states) for name, sense in senses.items()}
    touch_us, loop_us = (1e6 * taken_s / len(states) for taken_s in cpu_medians_s(candidates, rounds).values())
    contacts = float(np.mean([state.ncon for state in states]))
    return len(senses["touch"].receptors.names), contacts, touch_us, loop_us, loop_us / touch_us


def feel_all(sense, states) -> None:
    """Feel some states."""
    for state in states:
        sense(state)


def measure_steps(hands: str, pose: str, age_months: float, rounds: int) -> tuple[list[float], list[float]]:
    """Return the CPU time of a control step bare, without touch and with it, in µs, and the rates of these to bare."""
    without = open_infant(hands, pose, age_months, SENSES)
    touching = open_infant(hands, pose, age_months, {**SENSES, "touch": {}})
    model, commands = without.unwrapped.model, random_commands(without)
    data = mujoco.MjData(model)
    candidates = {
        "bare": partial(bare, model, data, model.key(pose).id, commands),
        "without": partial(felt, without, commands),
        "with": partial(felt, touching, commands),
    }
    times_us = [1e6 * taken_s / CONTROL_STEPS for taken_s in cpu_medians_s(candidates, rounds).values()]
    if not all(np.array_equal(env.unwrapped.data.qpos, data.qpos) for env in (without, touching)):
        raise SystemExit("they did not go through the same states")
    return times_us, [times_us[0] / time_us for time_us in times_us[1:]]


def open_infant(hands: str, pose: str, age_months: float, senses: dict):
    """Return the environment of an infant on a floor."""
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "body": {"hands": hands}}
    spec |= {"senses": senses, "scene": {"kind": "flat", "pose": pose}}
    return mimoc.make(mimoc.build(mimoc.InfantSpec.model_validate(spec)))


def random_commands(env) -> np.ndarray:
    """Return the commands of an episode."""
    shape = (CONTROL_STEPS, *env.action_space.shape)
    return np.random.default_rng(0).uniform(-1, 1, shape).astype(np.float32)


if __name__ == "__main__":
    main()
