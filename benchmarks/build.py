"""What building costs: a spec to a bundle in memory, and `mimo build` beside the imports it cannot do without.

    python benchmarks/build.py [--rounds 20]

Wanted: under 50 ms at the median after the first; the command under 1.5 times the imports.
"""

import argparse
import sys
import tempfile
import time
from pathlib import Path

from measuring import command_medians_s, cpu_medians_s

import mimoc

CONFIG = Path(__file__).parents[1] / "configs" / "nine_months.yaml"
IMPORTS = "import mujoco, pydantic, jinja2, scipy.optimize"


def main() -> None:
    """Print two rows."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rounds", type=int, default=20)
    rounds = parser.parse_args().rounds
    start = time.process_time()
    build_config()
    first_s = time.process_time() - start
    build_s = cpu_medians_s({"build": build_config}, rounds)["build"]
    print(f"spec to bundle in memory: {build_s * 1e3:.0f} ms (the first, with its imports: {first_s * 1e3:.0f} ms)")
    with tempfile.TemporaryDirectory() as folder:
        out = str(Path(folder) / "out")
        medians_s = command_medians_s(
            {
                "mimo build": [sys.executable, "-m", "mimoc", "build", str(CONFIG), "-o", out, "--force"],
                "imports": [sys.executable, "-c", IMPORTS],
            },
            rounds,
        )
    command_s, imports_s = medians_s["mimo build"], medians_s["imports"]
    print(
        f"mimo build: {command_s * 1e3:.0f} ms; {IMPORTS}: {imports_s * 1e3:.0f} ms; ratio {command_s / imports_s:.2f}"
    )


def build_config() -> mimoc.Bundle:
    return mimoc.build(mimoc.load_spec(CONFIG))


if __name__ == "__main__":
    main()
