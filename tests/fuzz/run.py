"""Runs fuzzers for a time, each try watched from another process: `python tests/fuzz/run.py --minutes 5`.

A try that fails can be repeated: `python tests/fuzz/run.py bundles --seed 0 --try 17`.
"""

import argparse
import json
import os
import selectors
import subprocess
import sys
import tempfile
import time
from collections import Counter
from dataclasses import asdict
from pathlib import Path
from shutil import rmtree

from fuzz.fuzzing import FUZZERS, LARGEST_MB, LONGEST_S, Canaries, Outcome, fuzzer, peak_mb, run_try
from fuzz.strange_infants import CANARIES

TRIES_OF_A_PROCESS = 500


def main() -> int:
    asked = _arguments()
    if asked.worker:
        return _work(asked.names[0], asked.seed, asked.one_try, asked.tries)
    faults = 0
    for name in asked.names or FUZZERS:
        if asked.one_try is not None:
            faults += Run(name, asked.seed).go(asked.one_try, asked.one_try + 1, float("inf"))
        else:
            until = time.monotonic() + 60 * asked.minutes / len(asked.names or FUZZERS)
            faults += Run(name, asked.seed).go(0, asked.tries, until)
    return 1 if faults else 0


class Run:
    """The tries of one fuzzer, in processes that are replaced when they die or hang."""

    def __init__(self, name: str, seed: int):
        self.name, self.seed = name, seed
        self.results, self.slowest_s, self.largest_mb = Counter[str](), 0.0, 0.0
        self.longest_s, self.limit_mb = LONGEST_S, LARGEST_MB

    def go(self, first: int, end: int, until: float) -> int:
        """Make tries from one number to another, or until a time; print what came of them, and return the faults."""
        number = first
        while number < end and time.monotonic() < until:
            number = self._go_on(number, min(end, number + TRIES_OF_A_PROCESS), until)
        tried, faults = self.results.total(), self.results["fault"]
        print(
            f"{self.name}: {tried} tries from seed {self.seed}: {self.results['used']} used, "
            f"{self.results['refused']} refused in clear lines, {faults} faults; "
            f"slowest {self.slowest_s:.1f} s, most memory {self.largest_mb:.0f} MB",
            flush=True,
        )
        return faults

    def _go_on(self, first: int, end: int, until: float) -> int:
        """Make tries in one process; return the number of the next one."""
        command = [sys.executable, __file__, self.name, "--worker", "--seed", str(self.seed)]
        command += ["--try", str(first), "--tries", str(end - first)]
        # What is refused while pictures are drawn shall not be lost in what OpenGL prints.
        with subprocess.Popen(command, stdout=subprocess.PIPE, bufsize=0) as process:
            assert process.stdout
            lines, number = _Lines(process.stdout.fileno()), first
            ready = lines.next(timeout_s=300)  # It has prepared itself.
            if ready is None:
                self._fault(number, "the process ended before its first try")
                return number + 1
            self.longest_s, self.limit_mb = ready["longest_s"], ready["largest_mb"]
            while number < end and time.monotonic() < until:
                start = time.monotonic()
                line = lines.next(timeout_s=20 * self.longest_s)
                taken_s = time.monotonic() - start
                if line is None:
                    process.kill()
                    self._fault(number, f"no answer after {taken_s:.0f} s (process ended: {process.wait()})")
                    return number + 1
                self._count(Outcome(**line["outcome"]), line["cpu_s"], line["peak_mb"])
                number += 1
            process.kill()
        return number

    def _count(self, outcome: Outcome, cpu_s: float, memory_mb: float) -> None:
        self.slowest_s, self.largest_mb = max(self.slowest_s, cpu_s), max(self.largest_mb, memory_mb)
        if outcome.is_fault:
            self._fault(outcome.number, outcome.result)
        elif cpu_s > self.longest_s:
            self._fault(outcome.number, f"{outcome.result} after {cpu_s:.1f} s of CPU time")
        elif memory_mb > self.limit_mb:
            self._fault(outcome.number, f"{outcome.result} with {memory_mb:.0f} MB")
        else:
            self.results[outcome.result] += 1

    def _fault(self, number: int, what: str) -> None:
        self.results["fault"] += 1
        print(f"{self.name} --seed {self.seed} --try {number}: {what}", flush=True)


class _Lines:
    """JSON lines from a pipe, each of which is waited for only so long."""

    def __init__(self, handle: int):
        self._handle, self._rest = handle, b""
        self._selector = selectors.DefaultSelector()
        self._selector.register(handle, selectors.EVENT_READ)

    def next(self, timeout_s: float) -> dict | None:
        """Return the next line, None if there is none in time or the process has ended."""
        end = time.monotonic() + timeout_s
        while b"\n" not in self._rest:
            if not self._selector.select(max(0.0, end - time.monotonic())):
                return None
            found = os.read(self._handle, 2**16)
            if not found:
                return None
            self._rest += found
        line, _, self._rest = self._rest.partition(b"\n")
        return json.loads(line)


def _work(name: str, seed: int, first: int, count: int) -> int:
    answers = os.fdopen(os.dup(1), "w", buffering=1)
    os.dup2(2, 1)  # What else is printed is no answer.
    made = fuzzer(name)
    with tempfile.TemporaryDirectory(prefix="mimoc-fuzz-") as place:
        root = Path(place)
        watch = Canaries(root / "outside", CANARIES)
        (root / "prepared").mkdir()
        prepared = made.prepare(root / "prepared")
        print(json.dumps({"longest_s": made.longest_s, "largest_mb": made.largest_mb}), file=answers)
        for number in range(first, first + count):
            folder = root / "try"
            folder.mkdir()
            start = time.process_time()
            outcome = run_try(made, prepared, seed, number, folder, watch)
            line = {"outcome": asdict(outcome), "cpu_s": time.process_time() - start, "peak_mb": peak_mb()}
            print(json.dumps(line), file=answers)
            rmtree(folder, ignore_errors=True)
    return 0


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("names", nargs="*", help=f"fuzzers: {', '.join(FUZZERS)}; all by default")
    parser.add_argument("--minutes", type=float, default=5.0, help="for all fuzzers together")
    parser.add_argument("--tries", type=int, default=10**9, help="of each fuzzer at most")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--try", type=int, dest="one_try", help="number of the only try")
    parser.add_argument("--worker", action="store_true", help=argparse.SUPPRESS)
    return parser.parse_args()


if __name__ == "__main__":
    sys.exit(main())
