"""Cost of rooms and toys: building, changing at a reset, memory and stepping.

    python benchmarks/rooms.py [--rounds 15]

Times are CPU times of this process. Stepping takes the same random commands through the same two physics steps of 5 ms
in every world, from the same pose; `flat` is the empty floor that the others are compared with.
"""

import argparse
import io
import itertools
import time
from collections.abc import Callable
from functools import partial
from statistics import median
from typing import Any

import mujoco
import numpy as np
from measuring import cpu_medians_s
from PIL import Image

import mimoc
from mimoc.compiler import building, model_check

CONTROL_STEPS = 100
SCENES = 4
SIX = {"count": [6, 6]}
WORLDS = {
    "flat": {"kind": "flat"},
    "room": {"kind": "room"},
    "room, six toys": {"kind": "room", "toys": SIX},
    "crib": {"kind": "crib"},
    "crib, six toys": {"kind": "crib", "toys": SIX},
}


def main() -> None:
    """Print what is wanted beside what is measured."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    rounds = parser.parse_args().rounds
    six, sees = WORLDS["room, six toys"], {"senses": {"vision": {}}}
    print(f"{'':44} {'measured':>9} {'wanted':>7}")
    row("build a room with six toys [ms]", 1e3 * timed(lambda _: mimoc.build(spec(six)), rounds), 150)
    blind, seeing = mimoc.make(spec(six)), mimoc.make(spec(six, **sees))
    row("reset to another scene [ms]", 1e3 * timed(partial(rescene, blind), rounds), 50)
    row("the same, of an infant that sees [ms]", 1e3 * timed(partial(rescene, seeing), rounds), 50)
    blind.close()
    seeing.close()
    builder = building.builder(spec({"kind": "room", "toys": {"count": [10, 10]}}))
    sizes = [weigh(builder(seed)) for seed in range(rounds)]
    row("bundle with ten toys, largest [MB]", max(size for size, _ in sizes), 5)
    row("its textures decoded, largest [MB]", max(decoded for _, decoded in sizes), 16)
    for pose in ("supine", "sitting"):
        compare_steps(pose, rounds)


def row(what: str, measured: float, wanted: float) -> None:
    print(f"{what:44} {measured:9.2f} {wanted:7g}", flush=True)


def spec(world: dict[str, Any], **others: Any) -> mimoc.InfantSpec:
    """Return the average child of nine months in a world."""
    return mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 9, "scene": world, **others})


def timed(call: Callable[[int], object], rounds: int) -> float:
    """Return the median CPU time of a call with 1, 2 and so on; the first one warms up and is not counted."""
    times = []
    for number in range(1, rounds + 2):
        start = time.process_time()
        call(number)
        times.append(time.process_time() - start)
    return median(times[1:])


def rescene(env: Any, seed: int) -> None:
    env.reset(options={"scene_seed": seed})


def weigh(bundle: mimoc.Bundle) -> tuple[float, float]:
    """Return how large a bundle is, and its textures as MuJoCo keeps them, in MB."""
    pictures = [Image.open(io.BytesIO(data)).size for name, data in bundle.files.items() if name.endswith(".png")]
    return sum(map(len, bundle.files.values())) / 1e6, sum(3 * width * height for width, height in pictures) / 1e6


def compare_steps(pose: str, rounds: int) -> None:
    """Print the time of a control step in each world, over that on an empty floor."""
    models = {
        (name, seed): model_check.compile_model(building.build(spec({**world, "pose": pose, "seed": seed})).files)
        for (name, world), seed in itertools.product(WORLDS.items(), range(SCENES))
    }
    commands = np.random.default_rng(0).uniform(-1, 1, (CONTROL_STEPS, models["flat", 0].nu))
    steps = {key: partial(episode, model, pose, commands) for key, model in models.items()}
    step_us = {key: 1e6 * s / CONTROL_STEPS for key, s in cpu_medians_s(steps, rounds).items()}
    flat_us = median(step_us["flat", seed] for seed in range(SCENES))
    for name in WORLDS:
        here_us = median(step_us[name, seed] for seed in range(SCENES))
        print(f"{f'{pose}, {name}: step [us]':44} {here_us:9.1f}")
        row(f"{pose}, {name}: times the empty floor", here_us / flat_us, 1.5)


def episode(model: mujoco.MjModel, pose: str, commands: np.ndarray) -> None:
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    for command in commands:
        data.ctrl[:] = command
        mujoco.mj_step(model, data, 2)


if __name__ == "__main__":
    main()
