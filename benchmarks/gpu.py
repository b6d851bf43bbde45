"""Physics steps a second of infants of seven ages on a GPU, each control step one captured graph.

    python benchmarks/gpu.py [--device cuda:0] [--infants 256,1024,4096,8192] [--steps 100] [--profile]
                             [--hands mitten,five_finger] [--senses "proprioception,touch sums,both eyes"]

`--device warp:cpu --infants 2 --steps 2` tries it out without a GPU; its numbers mean nothing. Fewer than seven infants
have the first of the ages.
"""

import argparse
import time

import numpy as np
import warp as wp

import mimoc
from mimoc.runtime.device.arrays import present

AGES_MONTHS = (0, 3, 6, 9, 12, 18, 24)
SENSES = {
    "proprioception": {"proprioception": {}, "vestibular": {}},
    "touch sums": {"proprioception": {}, "vestibular": {}, "touch": {}},
    "both eyes": {"proprioception": {}, "vestibular": {}, "vision": {}},
}
WARM_UP = 3
KERNELS = 15  # How many of the slowest kernels a profile shows.


def bundles(hands: str, senses: str) -> list[mimoc.Bundle]:
    spec = {"mimoc": 1, "name": "infant", "body": {"hands": hands}, "senses": SENSES[senses]}
    scene = {"kind": "flat", "pose": "supine"}
    ages = [{**spec, "age_months": age, "scene": scene} for age in AGES_MONTHS]
    return [mimoc.build(mimoc.InfantSpec.model_validate(each)) for each in ages]


def measure(sources: list[mimoc.Bundle], infants: int, device: str, steps: int, profile: bool) -> str:
    env = mimoc.make_vec(sources[:infants], infants, device=device, arrays="warp")
    env.reset(seed=0)
    commands = [command(env, seed) for seed in range(WARM_UP)]
    for each in commands:
        env.step(each)
    wp.synchronize_device(env.device)
    start = time.perf_counter()
    for step in range(steps):
        env.step(commands[step % WARM_UP])
    wp.synchronize_device(env.device)
    taken_s = time.perf_counter() - start
    rate = infants * steps * env.worlds.period / taken_s
    used_mb = wp.get_mempool_used_mem_current(env.device) / 1e6 if env.device.is_cuda else 0
    if profile:
        show_kernels(env)
    room = env.room
    env.close()
    return (
        f"{rate:12,.0f} physics steps/s  {used_mb:8,.0f} MB  contacts {room.contacts}, constraints {room.constraints}"
    )


def command(env, seed: int) -> wp.array:
    generator = np.random.default_rng(seed)
    space = env.single_action_space
    return wp.array(generator.uniform(space.low, space.high, env.action_space.shape), dtype=float, device=env.device)


def show_kernels(env) -> None:
    """Print which kernels take how much of a control step that is not captured."""
    env.worlds.captures = False
    with present(env.device):
        wp.timing_begin(cuda_filter=wp.TIMING_KERNEL)
        env.worlds.step()
        taken_ms: dict[str, float] = {}
        for each in wp.timing_end():
            taken_ms[each.name] = taken_ms.get(each.name, 0.0) + each.elapsed
    total_ms = sum(taken_ms.values())
    for name, ms in sorted(taken_ms.items(), key=lambda each: -each[1])[:KERNELS]:
        print(f"    {100 * ms / total_ms:5.1f} %  {ms:8.3f} ms  {name}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--device", default="cuda:0")
    parser.add_argument("--infants", default="256,1024,4096,8192")
    parser.add_argument("--steps", type=int, default=100)
    parser.add_argument("--hands", default="mitten,five_finger")
    parser.add_argument("--senses", default=",".join(SENSES))
    parser.add_argument("--profile", action="store_true")
    options = parser.parse_args()
    wp.init()
    if options.device not in ["warp:cpu", *(each.alias for each in wp.get_devices())]:
        print(f"there is no device '{options.device}' on this machine, so nothing is measured")
        return
    for hands in options.hands.split(","):
        for senses in options.senses.split(","):
            sources = bundles(hands, senses)
            for infants in map(int, options.infants.split(",")):
                found = measure(sources, infants, options.device, options.steps, options.profile)
                print(f"{hands:11} {senses:14} {infants:6} infants {found}", flush=True)


if __name__ == "__main__":
    main()
