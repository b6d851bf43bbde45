"""Cohorts: 100 children at 7 ages, what a job costs besides its work, and a cohort that is killed thirty times."""

import argparse
import json
import os
import random
import resource
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from mimoc.studies.cohorts.cohort import Cohort
from mimoc.studies.cohorts.store import size_bytes

BASE = {
    "mimoc": 1,
    "name": "infant",
    "age_months": 9,
    "senses": {"proprioception": {}, "vestibular": {}},
    "scene": {"kind": "flat", "pose": "sitting"},
}
AGES = [0, 3, 6, 9, 12, 18, 24]
EMPTY = "def nothing(work):\n    return {}\n"


def cohort(folder: Path, **keys) -> Cohort:
    """Return a cohort whose file is in a folder, as JSON, which is YAML."""
    path = folder / "cohort.yaml"
    path.write_text(json.dumps({"mimoc": 1, "cohort": "bench", "base": BASE, **keys}))
    return Cohort(path)


def timed(study: Cohort, out: Path, **options) -> tuple[float, float]:
    """Do a cohort; return wall time and CPU time of all processes."""
    before, start = cpu_s(), time.perf_counter()
    status = study.run(out, **options)
    assert not status.failures, status.failures[0].error
    return time.perf_counter() - start, cpu_s() - before


def cpu_s() -> float:
    """Return the CPU time of this process and of those that it has waited for."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(each.ru_utime + each.ru_stime for each in used)


def many(folder: Path, children: int) -> None:
    """Build, check and measure children at seven ages."""
    study = cohort(folder, children={"draw": children, "seed": 1}, vary={"age_months": AGES}, do=["build", "check"])
    start = time.perf_counter()
    jobs = len(study.jobs())
    print(f"{jobs} jobs named in {time.perf_counter() - start:.2f} s")
    wall, cpu = timed(study, folder / "many")
    cores = len(os.sched_getaffinity(0))
    print(f"{children} children x 7 ages built and checked on {cores} cores: {wall:.0f} s, {cpu:.0f} s of CPU time")
    shared = size_bytes(folder / "many" / "assets")
    each = (size_bytes(folder / "many") - shared) / (7 * children)
    print(f"1,000 infants: {(shared + 1000 * each) / 1e6:.1f} MB, {each / 1000:.1f} kB each besides what they share")
    start = time.perf_counter()
    study.table(folder / "many")
    print(f"table of {jobs} rows: {time.perf_counter() - start:.2f} s")


def overhead(folder: Path, jobs: int) -> None:
    """Do jobs that do nothing, twice as many the second time, so that starting does not count."""
    (folder / "empty.py").write_text(EMPTY)
    walls, cpus = [], []
    for number in (jobs, 3 * jobs):
        study = cohort(folder, do=[{"python": {"function": "empty:nothing", "seeds": [*range(number)]}}])
        wall, cpu = timed(study, folder / f"empty{number}", processes=1)
        walls.append(wall)
        cpus.append(cpu)
    wall, cpu = (1000 * (each[1] - each[0]) / (2 * jobs) for each in (walls, cpus))
    print(f"job overhead, one process: {wall:.1f} ms of wall time, {cpu:.1f} ms of CPU time; start {walls[0]:.1f} s")


def on_cluster(folder: Path, jobs: int, on: str, address: str | None) -> None:
    """Do jobs that do nothing on a cluster, in tasks of one, ten and fifty jobs: wall time, with all starting."""
    (folder / "empty.py").write_text(EMPTY)
    study = cohort(folder, do=[{"python": {"function": "empty:nothing", "seeds": [*range(jobs)]}}])
    for size in (50, 10, 1):
        few = (
            study if size > 1 else cohort(folder, do=[{"python": {"function": "empty:nothing", "seeds": [*range(8)]}}])
        )
        options = {"jobs_per_task": size} | ({"address": address} if address else {})
        start = time.perf_counter()
        status = few.run(folder / f"{on}{size}", on, **options)
        assert not status.failures, status.failures[0].error
        wall = time.perf_counter() - start
        print(
            f"{on}, {size} jobs a task: {status.jobs} jobs in {wall:.1f} s, {wall / status.jobs:.3f} s a job",
            flush=True,
        )


def killed(folder: Path, times: int) -> None:
    """Kill a cohort at random moments, resume it each time, and compare the table with that of a whole run."""
    study = cohort(
        folder,
        children={"draw": 4, "seed": 2},
        vary={"age_months": AGES},
        do=["build", {"run": {"steps": 100, "seeds": [0, 1]}}],
    )
    study.run(folder / "whole")
    chance, kills = random.Random(0), 0
    command = [sys.executable, "-m", "mimoc", "cohort", "run", folder / "cohort.yaml", "-o", folder / "killed"]
    for _ in range(times):
        running = subprocess.Popen(command, stdout=subprocess.DEVNULL)
        try:
            running.wait(timeout=2 + 4 * chance.random())
        except subprocess.TimeoutExpired:
            running.send_signal(signal.SIGKILL)
            kills += 1
        running.wait()
    study.run(folder / "killed")
    same = all(
        one.read_bytes() == other.read_bytes()
        for one, other in zip(study.table(folder / "whole"), study.table(folder / "killed"), strict=True)
    )
    print(f"killed {kills} times of {times}: the table is {'the same' if same else 'ANOTHER'}")


def main() -> None:
    """Print all numbers."""
    options = argparse.ArgumentParser(description=__doc__)
    options.add_argument("--children", type=int, default=100)
    options.add_argument("--jobs", type=int, default=1000)
    options.add_argument("--kills", type=int, default=30)
    options.add_argument("--on", choices=("slurm", "ray"), help="only the job overhead on a cluster")
    options.add_argument("--address", help="address of the Ray cluster")
    chosen = options.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        if chosen.on:
            on_cluster(place, chosen.jobs, chosen.on, chosen.address)
            return
        overhead(place, chosen.jobs)
        if chosen.kills:
            killed(place, chosen.kills)
        if chosen.children:
            many(place, chosen.children)


if __name__ == "__main__":
    main()
