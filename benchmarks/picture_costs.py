"""What portraits and frames of videos cost to draw, beside another checkout of mimoc, such as the release before.

    python benchmarks/picture_costs.py [--before PATH_TO_MIMOC] [--rounds 3] [--pixels 1000]

Each round draws with each checkout in turn, in a process of its own; the medians of CPU time count. A portrait opens
OpenGL, draws once and closes it, as `mimoc render` does after the build; a frame is one of an open environment.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
from pathlib import Path

from measuring import cpu_medians_s

FRAME_PX = (640, 480)
TIMES = 3  # Of each picture in a process, besides a first one that does not count.
AGES = (0, 12)


def main() -> None:
    """Print the times of this checkout, and of the other one."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--before", type=Path)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--pixels", type=int, default=1000)
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.worker:
        print(json.dumps(times_ms(options.pixels)))
        return
    checkouts = {"now": Path(__file__).resolve().parents[1]}
    if options.before:
        checkouts = {"before": options.before.resolve(), **checkouts}
    taken: dict[str, list[dict[str, float]]] = {name: [] for name in checkouts}
    for _ in range(options.rounds):
        for name, checkout in checkouts.items():
            taken[name].append(worker(checkout, options.pixels))
    for what in taken["now"][0]:
        medians = {name: statistics.median(times[what] for times in rounds) for name, rounds in taken.items()}
        ratio = f", {medians['now'] / medians['before']:.2f} times" if "before" in medians else ""
        print(f"{what:28}", ", ".join(f"{name} {value:.0f} ms" for name, value in medians.items()) + ratio)


def worker(checkout: Path, pixels: int) -> dict[str, float]:
    """Return the times of a checkout, measured in a new process."""
    command = [sys.executable, __file__, "--worker", "--pixels", str(pixels)]
    done = subprocess.run(command, env=os.environ | {"PYTHONPATH": str(checkout)}, capture_output=True, check=True)
    return json.loads(done.stdout)


def times_ms(pixels: int) -> dict[str, float]:
    """Return the CPU time of each kind of picture, drawn with the mimoc that is imported."""
    import mimoc
    from mimoc.render.portrait import lineup, portrait

    bundles = {
        age: mimoc.build(mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "infant", "age_months": age}))
        for age in AGES
    }
    envs = {
        age: mimoc.make(bundle, render_mode="rgb_array", width=FRAME_PX[0], height=FRAME_PX[1])
        for age, bundle in bundles.items()
    }
    calls = {}
    for age, bundle in bundles.items():
        calls[f"portrait, {age} months"] = lambda bundle=bundle: portrait(bundle, "sitting", pixels, pixels)
        envs[age].reset(seed=0)
        calls[f"frame, {age} months"] = envs[age].render
    calls["row of two"] = lambda: lineup(list(bundles.values()), "sitting", pixels, pixels // 2)
    return {what: 1000 * seconds for what, seconds in cpu_medians_s(calls, TIMES).items()}


if __name__ == "__main__":
    main()
