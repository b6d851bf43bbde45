"""Memory use: resident size over many control steps.

    python benchmarks/memory.py [--steps 100000]    (ten minutes)

Each infant runs in a process of its own, with random actions and a reset every 1,000 steps. Wanted: no growth, at most
200 MB with touch and 400 MB with vision. Also opens and closes environments that see, over and over: what an OpenGL
context takes is given back.
"""

import argparse
import multiprocessing
import sys
from pathlib import Path

import mimoc

PROPRIOCEPTION = {"proprioception": {}, "vestibular": {}}
TOUCH = {**PROPRIOCEPTION, "touch": {}}
VISION = {"vision": {"foveation": 5}}
INFANTS = {
    "touch, mitten": ("mitten", TOUCH),
    "touch, five fingers": ("five_finger", TOUCH),
    "vision": ("mitten", VISION),
    "all senses": ("mitten", {**TOUCH, **VISION}),
}
EPISODE = 1000


def main() -> None:
    """Print one row for each infant."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=100_000)
    steps = parser.parse_args().steps
    processes = multiprocessing.get_context("spawn")
    print(f"{'infant':20} {'steps':>7} {'at a tenth [MB]':>16} {'at the end [MB]':>16}")
    for name, (hands, senses) in INFANTS.items():
        with processes.Pool(1) as pool:
            early_mb, late_mb = pool.apply(run, (hands, senses, steps))
        print(f"{name:20} {steps:7} {early_mb:16.0f} {late_mb:16.0f}", flush=True)
    with processes.Pool(1) as pool:
        early_mb, late_mb = pool.apply(open_and_close, (200,))
    print(f"{'opened and closed':20} {200:7} {early_mb:16.0f} {late_mb:16.0f}")


def run(hands: str, senses: dict, steps: int) -> tuple[float, float]:
    """Return the resident size after a tenth of some steps and after all of them, in MB."""
    env = mimoc.make(infant(hands, senses))
    env.action_space.seed(0)
    for step in range(steps):
        if step % EPISODE == 0:
            env.reset(seed=0)
        env.step(env.action_space.sample())
        if step == steps // 10:
            early_mb = resident_mb()
    return early_mb, resident_mb()


def open_and_close(times: int) -> tuple[float, float]:
    """Return the resident size after a tenth of the times that an environment was opened and closed, and at the end."""
    bundle = infant("mitten", VISION)
    for time in range(times):
        env = mimoc.make(bundle)
        env.reset(seed=0)
        env.close()
        if time == times // 10:
            early_mb = resident_mb()
    return early_mb, resident_mb()


def infant(hands: str, senses: dict) -> mimoc.Bundle:
    """Return the bundle of an infant of nine months."""
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "body": {"hands": hands}, "senses": senses}
    return mimoc.build(mimoc.InfantSpec.model_validate(spec))


def resident_mb() -> float:
    """Return how much memory this process holds now."""
    if sys.platform != "linux":
        raise SystemExit("memory is measured on Linux only")
    lines = Path("/proc/self/status").read_text().splitlines()
    return next(int(line.split()[1]) for line in lines if line.startswith("VmRSS")) / 1024


if __name__ == "__main__":
    main()
