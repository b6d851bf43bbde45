"""Cost of building: a bundle in memory, and `mimoc build` compared with the imports it needs.

    python benchmarks/build.py [--rounds 20]

Wanted: under 50 ms at the median after the first, five fingers under 100; the command under 1.5 times the imports.
"""

import argparse
import sys
import tempfile
import time
from functools import partial
from pathlib import Path

from measuring import command_medians_s, cpu_medians_s

import mimoc

CONFIGS = Path(__file__).parents[1] / "configs"
CONFIG = CONFIGS / "nine_months.yaml"
IMPORTS = "import mujoco, pydantic, jinja2, scipy.optimize"


def main() -> None:
    """Print a row for each config, and one for the command."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=20)
    rounds = parser.parse_args().rounds
    start = time.process_time()
    build_config(CONFIG)
    first_s = time.process_time() - start
    builds = {path.stem: partial(build_config, path) for path in sorted(CONFIGS.glob("*.yaml"))}
    print(f"spec to bundle in memory (the first, with its imports: {first_s * 1e3:.0f} ms)")
    for name, build_s in cpu_medians_s(builds, rounds).items():
        print(f"    {name:18} {build_s * 1e3:3.0f} ms")
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "out")
        medians_s = command_medians_s(
            {
                "mimoc build": [sys.executable, "-m", "mimoc", "build", str(CONFIG), "-o", out, "--force"],
                "imports": [sys.executable, "-c", IMPORTS],
            },
            rounds,
        )
    command_s, imports_s = medians_s["mimoc build"], medians_s["imports"]
    print(
        f"mimoc build: {command_s * 1e3:.0f} ms; {IMPORTS}: {imports_s * 1e3:.0f} ms; ratio {command_s / imports_s:.2f}"
    )


def build_config(path: Path) -> mimoc.Bundle:
    return mimoc.build(mimoc.load_spec(path))


if __name__ == "__main__":
    main()
