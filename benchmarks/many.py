"""Control steps a second of many infants together, compared with one thread that does nothing but their physics.

    python benchmarks/many.py [--infants 64] [--threads 2] [--rounds 10] [--only touch]

The infants are of seven ages, supine, with 5 ms physics steps and 10 ms control steps, and get random commands. The
bare loop goes through the same states: it writes the command of each infant in turn and calls `mujoco.mj_step` for two
steps. All candidates go through the same control steps alternately, in wall time, so the machine should have as many
idle cores as threads; with `--cpu`, in CPU time of all threads. Wanted of two threads: 1.45 times the bare rate with
proprioception and balance, 1.2 with touch on the whole body, and with both eyes 1.5 times that of one environment.
"""

import argparse
import time
from collections.abc import Callable
from functools import partial
from statistics import median

import mujoco
import numpy as np

import mimoc

AGES_MONTHS = (0, 3, 6, 9, 12, 18, 24)
CONTROL_STEPS = 10
BALANCE = {"proprioception": {}, "vestibular": {}}
EYES = {"width_px": 64, "height_px": 64}
KINDS = {"balance": BALANCE, "touch": {**BALANCE, "touch": {}}, "vision": {**BALANCE, "vision": EYES}}


def main() -> None:
    """Print one row for each kind of infant."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--infants", type=int, default=64)
    parser.add_argument("--threads", type=int, default=2)
    parser.add_argument("--rounds", type=int, default=10)
    parser.add_argument("--only", choices=KINDS)
    parser.add_argument("--cpu", action="store_true")
    told = parser.parse_args()
    clock = time.process_time if told.cpu else time.perf_counter
    print(f"{'senses':10} {'bare':>9} {'single':>9} {'together':>9} [us an infant]  rate over bare, over single")
    for kind in [told.only] if told.only else KINDS:
        bare, single, together = measured_us(kind, told.infants, told.threads, told.rounds, clock)
        rates = bare / together, single / together
        print(f"{kind:10} {bare:9.1f} {single:9.1f} {together:9.1f} {'':15} {rates[0]:.2f}, {rates[1]:.2f}", flush=True)


def measured_us(
    kind: str, count: int, threads: int, rounds: int, clock: Callable[[], float]
) -> tuple[float, float, float]:
    """Return the median time of a control step of one infant: bare, in single environments, and together."""
    bundles = [bundle_of(kind, age) for age in AGES_MONTHS]
    env = mimoc.make_vec(bundles, count, threads=threads)
    env.reset(seed=0)
    alone = [mimoc.make(bundle) for bundle in bundles]
    commands = np.random.default_rng(0).uniform(-1, 1, (CONTROL_STEPS, *env.action_space.shape)).astype(np.float32)
    models = [infant.model for infant in env.infants]
    datas = [mujoco.MjData(model) for model in models]
    for infant, data in zip(env.infants, datas, strict=True):
        data.qpos[:] = infant.data.qpos
    candidates = {
        "bare": (partial(bare, models, datas, commands, env.infants[0].actuation.actuators), count),
        "single": (partial(in_turn, alone, commands), len(alone)),
        "together": (partial(together, env, commands), count),
    }
    times: dict[str, list[float]] = {name: [] for name in candidates}
    for round_ in range(rounds + 1):
        starts = [(model.key(infant.manifest.pose).id) for model, infant in zip(models, env.infants, strict=True)]
        for model, data, start in zip(models, datas, starts, strict=True):
            mujoco.mj_resetDataKeyframe(model, data, start)
            mujoco.mj_forward(model, data)
        env.reset(seed=0)
        for each in alone:
            each.reset(seed=0)
        for name, (call, infants) in candidates.items():
            start_s = clock()
            call()
            if round_:
                times[name].append(1e6 * (clock() - start_s) / CONTROL_STEPS / infants)
    if not all(np.array_equal(data.qpos, each.data.qpos) for data, each in zip(datas, env.infants, strict=True)):
        raise SystemExit("the two did not go through the same states")
    env.close()
    return median(times["bare"]), median(times["single"]), median(times["together"])


def bundle_of(kind: str, age_months: float) -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "senses": KINDS[kind]}
    return mimoc.build(mimoc.InfantSpec.model_validate(spec))


def bare(models: list, datas: list, commands: np.ndarray, driven: np.ndarray) -> None:
    for step in commands:
        for model, data, command in zip(models, datas, step, strict=True):
            data.ctrl[driven] = command
            mujoco.mj_step(model, data, 2)


def in_turn(envs: list, commands: np.ndarray) -> None:
    for step in commands:
        for env, command in zip(envs, step[: len(envs)], strict=True):
            env.step(command)


def together(env: object, commands: np.ndarray) -> None:
    for step in commands:
        env.step(step)  # pyright: ignore


if __name__ == "__main__":
    main()
