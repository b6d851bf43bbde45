"""Is this release as fast as another one? Both are measured in turn, in processes of their own.

    python benchmarks/releases.py /path/to/other/environment/bin/python

Prints for each measurement the median over the rounds of both, in CPU time, and the median of their ratios.
"""

import argparse
import json
import subprocess
import sys
from pathlib import Path
from statistics import median

from rich.console import Console
from rich.table import Table

CONFIGS = Path(__file__).parents[1] / "configs"
ROUNDS = 9

BUILD = """
spec = mimoc.load_spec(CONFIG)
mimoc.build(spec)
measured(lambda: mimoc.build(spec), 15)
"""
OPEN = """
bundle = mimoc.build(mimoc.load_spec(CONFIG))
measured(lambda: mimoc.InfantEnv(bundle).reset(seed=0), 9)
"""
STEP = """
env = mimoc.make(mimoc.build(mimoc.load_spec(CONFIG))).unwrapped
env.action_space.seed(0)
actions = [env.action_space.sample() for _ in range(100)]
env.reset(seed=0)
frames = round(env.manifest.step_ms / env.manifest.timestep_ms)
def bare():
    mujoco.mj_resetDataKeyframe(env.model, env.data, 0)
    for action in actions:
        env.data.ctrl[:] = 0
        mujoco.mj_step(env.model, env.data, frames)
def full():
    env.reset(seed=0)
    for action in actions:
        env.step(action)
full(); bare()
ratios = []
for _ in range(9):
    ratios.append(cpu(full) / cpu(bare))
print(json.dumps(median(ratios)))
"""
PRELUDE = """
import json, sys, time
from statistics import median
import mujoco, mimoc
CONFIG = sys.argv[1]
def cpu(function):
    start = time.process_time(); function(); return time.process_time() - start
def measured(function, times):
    print(json.dumps(1000 * median(cpu(function) for _ in range(times))))
"""
MEASUREMENTS = {
    "spec to bundle, nine months (ms)": (BUILD, "nine_months"),
    "spec to bundle, five fingers (ms)": (BUILD, "five_finger"),
    "spec to bundle, all senses (ms)": (BUILD, "all_senses"),
    "open and reset, nine months (ms)": (OPEN, "nine_months"),
    "control step / mj_step, nine months": (STEP, "nine_months"),
    "control step / mj_step, muscle": (STEP, "muscle"),
}


def run(python: str, code: str, config: str) -> float:
    """Return what a measurement prints in an environment."""
    command = [python, "-c", PRELUDE + code, str(CONFIGS / f"{config}.yaml")]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd="/")
    return json.loads(done.stdout)


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("other", help="Python of an environment with the other release")
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    options = parser.parse_args()
    table = Table("measurement", "other", "this", "this / other")
    for name, (code, config) in MEASUREMENTS.items():
        pairs = [(run(options.other, code, config), run(sys.executable, code, config)) for _ in range(options.rounds)]
        others, ours = zip(*pairs, strict=True)
        ratio = median(mine / other for other, mine in pairs)
        table.add_row(name, f"{median(others):.2f}", f"{median(ours):.2f}", f"{ratio:.3f}")
    Console().print(table)


if __name__ == "__main__":
    main()
