"""Cost of opening: from a bundle folder to the first observation, each time in a new process.

    python benchmarks/open.py [--rounds 15]

Wanted: under 300 ms, the imports of MuJoCo, Gymnasium and pydantic not counted, and under 300 MB resident with them.
"""

import argparse
import json
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import mimoc

CONFIG = Path(__file__).parents[1] / "configs" / "nine_months.yaml"
OPEN = """
import json, sys, time
import gymnasium, mujoco, pydantic

def most_resident_mb():
    with open("/proc/self/status") as status:
        return next(int(line.split()[1]) / 1024 for line in status if line.startswith("VmHWM"))

imported_mb = most_resident_mb()
start, cpu = time.perf_counter(), time.process_time()
import mimoc
env = mimoc.make(sys.argv[1])
env.reset(seed=0)
print(json.dumps({
    "wall [ms]": 1e3 * (time.perf_counter() - start),
    "CPU [ms]": 1e3 * (time.process_time() - cpu),
    "resident [MB]": most_resident_mb(),
    "of these before mimoc [MB]": imported_mb,
}))
"""


def main() -> None:
    """Print one row for each number."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=15)
    rounds = parser.parse_args().rounds
    with tempfile.TemporaryDirectory() as folder:
        out = mimoc.write_bundle(mimoc.build(mimoc.load_spec(CONFIG)), Path(folder) / "out")
        runs = [measured(out) for _ in range(rounds + 1)][1:]
    for what in runs[0]:
        print(f"{what:27} {statistics.median(run[what] for run in runs):6.0f}")


def measured(out: Path) -> dict[str, float]:
    """Return what a fresh process needs to open a bundle; the memory is the most that it ever held."""
    command = [sys.executable, "-c", OPEN, str(out)]
    return json.loads(subprocess.run(command, capture_output=True, check=True).stdout)


if __name__ == "__main__":
    main()
