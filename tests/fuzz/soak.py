"""Uses mimoc for hours, and sees whether memory and file handles stay flat: `python tests/fuzz/soak.py`.

Each of three parts runs in a process of its own: control steps, rooms of other seeds, and environments with eyes and
pictures that are opened and closed. What is held after a tenth of a part is compared with what is held at its end.
"""

import argparse
import gc
import multiprocessing
import os
import sys
import time
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

import mimoc

GROWTH_MB = 32.0
"""What resident memory may grow by after the first tenth; a leak of 1 MB whenever one is opened takes 180 MB."""
EPISODE = 1000  # Control steps until a reset.
LOOKS = 10  # How often memory and handles are looked at.
PROPRIOCEPTION = {"proprioception": {}, "vestibular": {}}
ROOM = {"kind": "room", "pose": "sitting", "toys": {"source": "builtin", "count": [3, 6], "size_cm": [4, 12]}}


@dataclass(frozen=True, slots=True)
class Held:
    rounds: int
    memory_mb: float
    handles: int


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, count in (("steps", 1_000_000), ("scenes", 1000), ("cycles", 200)):
        parser.add_argument(f"--{name}", type=int, default=count, help=f"{count:,} by default; 0 for none")
    asked = vars(parser.parse_args())
    if sys.platform != "linux":
        raise SystemExit("memory and file handles are looked at on Linux only")
    faults = 0
    for name, count in asked.items():
        if count:
            with multiprocessing.get_context("spawn").Pool(1) as pool:
                faults += pool.apply(_run, (name, count))
    return 1 if faults else 0


def steps(count: int) -> Iterator[None]:
    env = mimoc.make(_infant({**PROPRIOCEPTION, "touch": {}}))
    env.action_space.seed(0)
    for number in range(count):
        if number % EPISODE == 0:
            env.reset(seed=number)
        env.step(env.action_space.sample())
        yield
    env.close()


def scenes(count: int) -> Iterator[None]:
    for seed in range(count):
        env = mimoc.make(_infant(PROPRIOCEPTION, {**ROOM, "seed": seed}))
        env.reset(seed=seed)
        env.step(env.action_space.sample())
        env.close()
        yield


def cycles(count: int) -> Iterator[None]:
    bundle = _infant({"vision": {"foveation": 5}})
    for number in range(count):
        env = mimoc.make(bundle, render_mode="rgb_array")
        env.reset(seed=number)
        env.step(env.action_space.sample())
        env.render()
        env.close()
        yield


PARTS: Mapping[str, Callable[[int], Iterator[None]]] = {"steps": steps, "scenes": scenes, "cycles": cycles}


def looked_at(rounds: Iterator[None], count: int) -> Iterator[Held]:
    """Go through some rounds; yield what is held after each tenth of them."""
    each = max(1, count // LOOKS)
    for number, _ in enumerate(rounds, 1):
        if number % each == 0:
            yield held(number)


def held(rounds: int) -> Held:
    gc.collect()
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return Held(rounds, pages * os.sysconf("SC_PAGE_SIZE") / 2**20, len(os.listdir("/proc/self/fd")))


def growth(early: Held, late: Held) -> str:
    more_mb, more = late.memory_mb - early.memory_mb, late.handles - early.handles
    grown = [f"{more_mb:.0f} MB (at most {GROWTH_MB:.0f})"] if more_mb > GROWTH_MB else []
    grown += [f"{more} file handles"] if more > 0 else []
    return " and ".join(grown)


def _run(name: str, count: int) -> bool:
    """Run a part, and print what is held; return whether it has grown."""
    start, looks = time.monotonic(), []
    for look in looked_at(PARTS[name](count), count):
        looks.append(look)
        told = f"{look.memory_mb:.0f} MB, {look.handles} file handles, {time.monotonic() - start:.0f} s"
        print(f"{name}: {look.rounds:,} of {count:,}: {told}", flush=True)
    grown = growth(looks[0], looks[-1])
    print(f"{name}: {f'NOT FLAT: grown by {grown}' if grown else 'flat'}", flush=True)
    return bool(grown)


def _infant(senses: Mapping, scene: Mapping | None = None) -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": senses}
    return mimoc.build(mimoc.InfantSpec.model_validate({**spec, "scene": scene} if scene else spec))


if __name__ == "__main__":
    sys.exit(main())
