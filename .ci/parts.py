"""Run commands one after the other, up to the first that fails, and print how long each took: `make test`.

    python .ci/parts.py "NAME: COMMAND" ["NAME: COMMAND" ...]

CPU time is that of a command and of all processes that it waited for.
"""

import os
import subprocess
import sys
import time


def main() -> int:
    """Run the parts and return the exit code of the last."""
    rows, code = [], 0
    for part in sys.argv[1:]:
        name, _, command = part.partition(": ")
        print(f"== {command}", flush=True)
        wall_s, cpu_s = time.perf_counter(), _cpu_of_children_s()
        code = subprocess.run(command, shell=True, check=False).returncode
        rows.append((name, time.perf_counter() - wall_s, _cpu_of_children_s() - cpu_s))
        if code:
            break
    rows.append(("in all", sum(row[1] for row in rows), sum(row[2] for row in rows)))
    for name, wall_s, cpu_s in rows:
        print(f"{name:12}{wall_s:8.1f} s, of which the CPU worked {cpu_s:.1f} s")
    if code:
        print(f"{rows[-2][0]}: failed", file=sys.stderr)
    return code


def _cpu_of_children_s() -> float:
    times = os.times()
    return times.children_user + times.children_system


if __name__ == "__main__":
    sys.exit(main())
