"""Cohorts on a real SLURM of two nodes and a real Ray cluster of three, whose tasks and nodes are killed.

`make clusters` runs these; the ordinary tests leave them out, since they take minutes and need SLURM and Ray.
"""

import os
import re
import select
import signal
import subprocess
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from support.commands import process

from mimoc.base.errors import MimocError
from mimoc.schema.source import dump
from mimoc.studies.cohorts.cohort import Cohort

HERE = Path(__file__).parent
PATIENCE_S = 600.0
OWN = """
import os, signal, time
from pathlib import Path

def twice(work):
    return {"twice": 2 * work.seed}

def die(work):
    os.kill(os.getpid(), signal.SIGKILL)

def die_once(work):
    sign = Path(work.job.folder) / f"{work.store.folder.name}.died"
    if not sign.exists():
        sign.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"survived": True}

def outlive_its_node(work):
    pipe = Path(work.job.folder) / f"{work.store.folder.name}.pipe"
    if pipe.exists():
        with pipe.open("w") as told:
            pipe.unlink()
            told.write(f"{os.environ.get('SLURMD_NODENAME', '')} {os.getsid(0)}")
        time.sleep(3600)
    return {"survived": True}
"""


@dataclass(frozen=True)
class Cluster:
    """A cluster that is running."""

    on: str
    folder: Path
    options: tuple[str, ...]
    """Options of the command that runs a cohort on it."""

    def kill_node(self, name: str, session: str) -> None:
        """Kill the node of a process, given SLURM's name for it, and the process's session."""
        found = name or next(
            each for each in ("n1", "n2") if (self.folder / f"{each}.pid").read_text().strip() == session
        )
        script(self.on, "kill", self.folder, found)


def script(on: str, *arguments: object) -> str:
    """Run a script that starts, kills or stops a cluster; return the last line that it prints."""
    # Daemons keep what they inherit, so that a pipe would not end.
    log = Path(str(arguments[1])) / f"{arguments[0]}.txt"
    with log.open("w") as told:
        subprocess.run([HERE / f"{on}.sh", *map(str, arguments)], stdout=told, check=True)
    return log.read_text().strip().rpartition("\n")[2]


@pytest.fixture(scope="module", params=["slurm", "ray"])
def cluster(request, tmp_path_factory) -> Iterator[Cluster]:
    """Start a cluster, and let what is called here find it."""
    on, folder = request.param, tmp_path_factory.mktemp(request.param)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SLURM_CONF", str(folder / "slurm.conf"))
        patch.setenv("RAY_AUTH_MODE", "token")
        patch.setenv("RAY_AUTH_TOKEN_PATH", str(folder / "token"))
        try:
            address = script(on, "start", folder)
            yield Cluster(on, folder, ("--address", address) if on == "ray" else ())
        finally:
            script(on, "stop", folder)


@pytest.fixture
def write(tmp_path) -> Callable[..., Path]:
    """Return what writes a cohort file that has some steps."""
    (tmp_path / "own.py").write_text(OWN)

    def write(*steps: object) -> Path:
        path = tmp_path / "cohort.yaml"
        base = {"mimoc": 1, "name": "infant", "age_months": 9}
        path.write_text(dump({"mimoc": 1, "cohort": "small", "base": base, "do": [*steps]}))
        return path

    return write


def tables(cohort: Path, *outs: Path) -> list[list[bytes]]:
    return [[path.read_bytes() for path in Cohort(cohort).table(out)] for out in outs]


def run(cohort: Path, out: Path, cluster: Cluster) -> subprocess.Popen[str]:
    """Start a cohort on a cluster."""
    return process("cohort", "run", cohort, "-o", out, "--on", cluster.on, "--jobs-per-task", 3, *cluster.options)


def test_a_job_that_kills_its_task_is_a_failed_row_and_a_second_run_does_what_is_missing(cluster, write, tmp_path):
    cohort, out = write({"python": {"function": "own:twice", "seeds": "0:4"}}, {"python": "own:die"}), tmp_path / "out"
    running = run(cohort, out, cluster)
    running.communicate(timeout=PATIENCE_S)
    study = Cohort(cohort)
    (failure,) = study.status(out).failures
    assert running.returncode == 1
    assert failure.error.endswith(", 2 times; see the log")
    first = study.jobs()[0]
    result = out / "results" / first.key[:2] / f"{first.key}.json"
    result.unlink()
    running = run(cohort, out, cluster)
    running.communicate(timeout=PATIENCE_S)
    assert study.status(out).number("ok") == 4


@pytest.mark.parametrize("address", ["nonsense", "127.0.0.1:1", "ray://127.0.0.1:1", "nowhere.invalid:6379"])
def test_without_a_ray_cluster_at_the_address_nothing_is_written(address, write, tmp_path):
    with pytest.raises(MimocError, match=f"^there is no Ray cluster at '{re.escape(address)}' "):
        Cohort(write("build")).run(tmp_path / "out", "ray", address=address)
    assert not (tmp_path / "out").exists()


def test_with_a_task_and_a_node_killed_the_table_is_the_one_of_local_processes(cluster, write, tmp_path):
    cohort = write(
        "build",
        {"run": {"steps": 5, "seeds": "0:4"}},
        {"python": "own:die_once"},
        {"python": {"function": "own:outlive_its_node", "seeds": "0:2"}},
        {"python": {"function": "own:twice", "seeds": "0:9"}},
    )
    local, out, pipe = tmp_path / "local", tmp_path / "out", tmp_path / "out.pipe"
    assert Cohort(cohort).run(local).number("ok") == 17
    os.mkfifo(pipe)
    told = os.open(pipe, os.O_RDWR)
    running = run(cohort, out, cluster)
    try:
        assert select.select([told], [], [], PATIENCE_S)[0], "no job has begun"
        cluster.kill_node(*os.read(told, 100).decode().split(" "))
        running.communicate(timeout=PATIENCE_S)
    finally:
        os.close(told)
        running.send_signal(signal.SIGINT)
    assert running.returncode == 0
    one, other = tables(cohort, local, out)
    assert one == other
    assert one[0].count(b",ok,") == 17
