"""Jobs that are done, that fail, that are killed, and that are done elsewhere."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import mujoco
import pytest
from support.commands import process
from support.full import FULL

import mimoc
from mimoc.base.errors import BundleError, MimocError, OutputError
from mimoc.compiler import explain
from mimoc.studies.cohorts import run_jobs as performing
from mimoc.studies.cohorts.clusters import End, RefusedError, do_on, tasks_of
from mimoc.studies.cohorts.cohort import Cohort, plan
from mimoc.studies.cohorts.run_jobs import PINNED, run_jobs
from mimoc.studies.cohorts.store import Store, size_bytes

OWN = """
import os, signal, sys
from pathlib import Path

def probe(work, at=None):
    if at is not None and work.seed == at:
        raise ValueError("too heavy")
    return {"twice": 2 * work.seed}

def die(work):
    os.kill(os.getpid(), signal.SIGKILL)

def die_once(work):
    sign = Path(work.job.folder) / "died"
    if not sign.exists():
        sign.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return {"survived": True}

def leave(work):
    print("about to leave")
    sys.exit(3)

def strange(work):
    return {"number": 2**64} if work.seed else {"row": __import__("numpy").zeros(3)}

def name_of(work):
    return work.bundle.manifest.name
"""


@pytest.fixture
def own(tmp_path) -> Path:
    path = tmp_path / "own.py"
    path.write_text(OWN)
    return path


def test_every_job_leaves_a_row_with_its_factors_measures_and_versions(cohort, here, tmp_path):
    study = cohort(
        children={"draw": 1}, vary={"age_months": [3, 6]}, do=["build", {"run": {"steps": 5, "seeds": "0:2"}}]
    )
    calls = []
    status = study.run(tmp_path / "out", here, progress=lambda done, total: calls.append((done, total)))
    assert (status.jobs, status.number("ok"), calls[0], calls[-1]) == (6, 6, (0, 6), (6, 6))
    rows = study.rows(tmp_path / "out")
    assert [(row["age_months"], row["step"], row["seed"]) for row in rows[:3]] == [
        (3, "build", None),
        (3, "run", 0),
        (3, "run", 1),
    ]
    child = mimoc.build(study.specs[0]).manifest.child
    assert all(row["length_cm"] == child.length_cm for row in rows[:3])
    assert rows[1]["joint_speed_rad_s"] != rows[2]["joint_speed_rad_s"]
    assert {row["version.mimoc"] for row in rows} == {mimoc.__version__}
    assert rows[0]["sex"] == "female"
    assert rows[0]["length_percentile"] == rows[3]["length_percentile"]


def test_a_run_is_recorded_if_asked_and_has_the_key_of_old_if_not(cohort, here, tmp_path):
    def runs(**options):
        return cohort(do=[{"run": {"steps": 5, "seeds": "0:2", **options}}])

    assert "record" not in runs(record=False).jobs()[0].options
    study = runs(record=True)
    study.run(tmp_path / "out", here)
    recordings = [mimoc.read_recording(mark.parent) for mark in (tmp_path / "out" / "runs").rglob("recording.json")]
    assert [episode.steps for recording in recordings for episode in recording] == [5, 5]


@pytest.mark.full
def test_a_plan_counts_what_recordings_of_all_steps_take(cohort, tmp_path):
    sizes = [
        plan(cohort(do=[{"run": {"steps": steps, "record": True}}]), tmp_path / "out").steps[0].bytes
        for steps in (1000, 4000)
    ]
    assert sizes[1] > 1.5 * sizes[0]


def test_a_check_says_whether_the_infant_is_stable(cohort, here, tmp_path):
    study = cohort(do=["check"])
    study.run(tmp_path / "out", here)
    (row,) = study.rows(tmp_path / "out")
    assert row["stable"] is True
    assert 0 < row["energy_j_per_kg"] < 2  # 1.6; limbs whose joints were overdamped had .6.


def test_a_failed_job_is_a_row_with_its_error_and_the_others_go_on(cohort, here, own, tmp_path):
    probe = {"function": "own:probe", "seeds": "0:3", "options": {"at": 1}}
    study = cohort(do=[{"python": probe}, {"python": "own:leave"}])
    status = study.run(tmp_path / "out", here)
    assert [failure.error for failure in status.failures] == ["ValueError: too heavy", "SystemExit: 3"]
    rows = study.rows(tmp_path / "out")
    assert [row["status"] for row in rows] == ["ok", "failed", "ok", "failed"]
    assert [row["twice"] for row in rows] == [0, None, 4, None]
    assert "raise ValueError" in (tmp_path / "out" / rows[1]["log"]).read_text()
    assert (tmp_path / "out" / rows[3]["log"]).read_text().startswith("about to leave\n")


def test_what_no_table_can_hold_is_a_failed_job(cohort, here, own, tmp_path):
    status = cohort(do=[{"python": {"function": "own:strange", "seeds": [0, 1]}}]).run(tmp_path / "out", here)
    assert {each.job.seed: each.error for each in status.failures} == {
        0: "'own:strange' measured a ndarray; return a number, a text or None",
        1: "'own:strange' measured a whole number of more than 64 bits; return it as a float",
    }


def test_a_log_that_cannot_be_written_is_one_clear_error(cohort, own, tmp_path, monkeypatch):
    """`/dev/full` is like a full disk."""
    monkeypatch.setattr(performing, "open_new_file", lambda path, below: os.open("/dev/full", os.O_WRONLY))
    (job,) = cohort(do=[{"python": {"function": "own:probe", "options": {"at": 0}}}]).jobs()
    with pytest.raises(OutputError, match=r"\.txt: cannot be written \(No space left on device\); choose another"):
        run_jobs([job], Store(tmp_path))


@pytest.mark.slow
def test_a_folder_that_cannot_be_written_any_more_ends_the_run_with_one_clear_error(write, own, tmp_path, invoke):
    own.write_text(
        "def spoil(work):\n    results = work.store.folder / 'results'\n    results.rmdir()\n    results.touch()\n"
    )
    done = invoke("cohort", "run", write(do=[{"python": "own:spoil"}]), "-o", tmp_path / "out", "--processes", 1)
    assert (done.code, len(done.err.splitlines())) == (2, 1)
    assert "cannot be written (Not a directory); choose another place" in done.err


def test_a_package_that_cannot_be_imported_is_one_clear_error(cohort, tmp_path):
    (tmp_path / "broken").mkdir()
    (tmp_path / "broken" / "__init__.py").write_text("1 / 0")
    with pytest.raises(MimocError, match=r"'broken.in:f': its package cannot be imported \(division by zero\)"):
        cohort(do=[{"python": "broken.in:f"}]).jobs()


def test_only_a_retry_does_failed_jobs_again(cohort, here, own, tmp_path):
    study = cohort(do=[{"python": {"function": "own:probe", "seeds": "0:2", "options": {"at": 1}}}])
    study.run(tmp_path / "out", here)
    assert study.run(tmp_path / "out", here).number("failed") == 1
    status = study.retry(tmp_path / "out", here)
    assert (status.number("failed"), status.number("ok")) == (1, 1)
    results = {path: path.stat().st_mtime_ns for path in (tmp_path / "out" / "results").rglob("*.json")}
    study.retry(tmp_path / "out", here)
    again = {path for path, at in results.items() if path.stat().st_mtime_ns != at}
    assert len(again) == 1


def test_an_infant_that_cannot_be_built_is_a_failed_job(cohort, here, tmp_path):
    """Which the spec alone does not tell."""
    study = cohort(children=[{"sex": "male", "length_percentile": 0.001, "weight_percentile": 99.999}])
    (failure,) = study.run(tmp_path / "out", here).failures
    assert "body.individual" in failure.error
    assert "cannot weigh" in failure.error


def test_a_changed_cohort_keeps_what_is_still_valid(cohort, here, tmp_path, monkeypatch):
    cohort(vary={"age_months": [3, 6]}).run(tmp_path / "out", here)
    done = []
    written = Store.write

    def write(store, job, result):
        done.append(job.factors)
        written(store, job, result)

    monkeypatch.setattr(Store, "write", write)
    larger = cohort(vary={"age_months": [3, 6, 9]})
    assert larger.status(tmp_path / "out").number("missing") == 1
    larger.run(tmp_path / "out", here)
    assert done == [{"age_months": 9}]
    assert [row["status"] for row in larger.rows(tmp_path / "out")] == ["ok"] * 3


@FULL
@pytest.mark.slow
def test_the_table_is_the_same_to_the_byte_in_two_processes_and_in_shares(cohort, here, own, tmp_path):
    study = cohort(
        children={"draw": 2},
        do=["build", {"run": {"steps": 5}}],
        measure=["length_cm", "hip_path_m", "own:name_of"],
    )
    study.run(tmp_path / "two", processes=2)
    for index in (2, 0, 1):
        study.run(tmp_path / "shares", here, index=index, of=3)
    tables = [[path.read_bytes() for path in study.table(tmp_path / name)] for name in ("two", "shares")]
    assert tables[0] == tables[1]
    assert tables[0][0].count(b",ok,") == 4


@pytest.mark.full
@pytest.mark.slow
def test_a_job_whose_process_is_killed_is_begun_again_and_has_failed_the_second_time(cohort, own, tmp_path):
    study = cohort(do=[{"python": "own:die_once"}, {"python": "own:die"}, {"python": "own:probe"}])
    status = study.run(tmp_path / "out", processes=1)
    assert [each.error for each in status.failures] == ["the process was killed by signal 9, 2 times; see the log"]
    assert [row["status"] for row in study.rows(tmp_path / "out")] == ["ok", "failed", "ok"]


KILLED = """
import os, random, signal, sys
from pathlib import Path
import mimoc
from mimoc.studies.cohorts.run_jobs import run_jobs
from mimoc.studies.cohorts.store import Store

study, store, chance = mimoc.read_cohort(sys.argv[1]), Store(Path(sys.argv[2])), random.Random(1)
mimoc.build(study.specs[0])  # So that no process has to read mimoc's tables.
jobs = study.jobs()

def die_at(moment):
    before = iter(range(moment))

    def heed(event, details):
        if event in ("open", "os.rename", "os.mkdir", "os.remove") and next(before, None) is None:
            os.kill(os.getpid(), signal.SIGKILL)

    sys.addaudithook(heed)

for moment in [chance.randrange(100) for _ in range(30)]:
    if not (child := os.fork()):
        die_at(moment)
        store.create("small")
        run_jobs(jobs, store)
        os._exit(0)
    os.waitpid(child, 0)
"""


@pytest.mark.full
@pytest.mark.slow
def test_jobs_that_are_killed_at_thirty_random_moments_are_resumed_to_the_same_table(cohort, here, tmp_path):
    """Just before it opens, names or removes a file or makes a folder; `benchmarks/cohorts.py` kills whole commands."""
    study = cohort(do=[{"run": {"steps": 3, "seeds": "0:9"}}, "build"])
    study.run(tmp_path / "whole", here)
    command = [sys.executable, "-c", KILLED, tmp_path / "cohort.yaml", tmp_path / "out"]
    subprocess.run(command, check=True, env={**os.environ, **PINNED})
    kept = study.status(tmp_path / "out")
    assert kept.number("ok") > 0
    assert kept.number("failed") == 0
    study.run(tmp_path / "out", here)
    assert [path.read_bytes() for path in study.table(tmp_path / "out")] == [
        path.read_bytes() for path in study.table(tmp_path / "whole")
    ]


def test_ctrl_c_keeps_what_is_finished_and_leaves_no_process_behind(write, tmp_path, invoke):
    (tmp_path / "slow.py").write_text(
        "import os, signal, time\n"
        "from pathlib import Path\n"
        "def wait(work):\n"
        "    if work.seed:\n"
        "        (Path(work.job.folder) / 'pid').write_text(str(os.getpid()))\n"
        "        os.kill(os.getppid(), signal.SIGINT)\n"
        "        time.sleep(600)\n"
    )
    path = write(do=[{"python": {"function": "slow:wait", "seeds": [0, 1]}}])
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        done = invoke("cohort", "run", path, "-o", tmp_path / "out", "--processes", 1)
    finally:
        signal.signal(signal.SIGINT, before)
    assert (done.code, done.err.strip().splitlines()[0]) == (130, "stopped; run the same command again to resume")
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), signal.SIGKILL)
    assert mimoc.read_cohort(path).status(tmp_path / "out").number("ok") == 1


def test_a_process_ends_with_the_one_that_started_it(write, tmp_path):
    """Even if that one is killed and the job takes long."""
    (tmp_path / "slow.py").write_text(
        "import os, time\n"
        "from pathlib import Path\n"
        "def wait(work):\n"
        "    sign = Path(work.job.folder) / 'pid'\n"
        "    sign.with_suffix('.part').write_text(str(os.getpid()))\n"
        "    sign.with_suffix('.part').rename(sign)\n"
        "    os.kill(os.getppid(), 9)\n"
        "    while True:\n"
        "        time.sleep(0.01)\n"
    )
    path = write(do=[{"python": "slow:wait"}])
    running = process("cohort", "run", path, "-o", tmp_path / "out")
    running.communicate()
    assert running.returncode == -signal.SIGKILL
    worker = int((tmp_path / "pid").read_text())
    while _is_running(worker):
        os.sched_yield()


def _is_running(process: int) -> bool:
    try:
        state = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0]
    except FileNotFoundError:
        return False
    return state != "Z"


@pytest.mark.extras
@pytest.mark.slow
def test_a_training_is_a_job_whose_folder_names_it_and_its_cohort(cohort, here, tmp_path):
    hyper = {"n_steps": 32, "batch_size": 64, "n_epochs": 1, "width": 8, "layers": 1}
    base = {"mimoc": 1, "name": "x", "age_months": 18, "senses": {"proprioception": {}}}
    study = cohort(
        base={**base, "task": {"kind": "reach", "steps": 30}},
        vary={"age_months": [18]},
        do=[{"train": {"steps": 64, "envs": 2, "seeds": [4], "hyper": hyper}}],
    )
    status = study.run(tmp_path / "out", here)
    assert not status.failures
    (row,) = study.rows(tmp_path / "out")
    assert (row["seed"], row["episodes"], row["success"] is not None) == (4, 2, True)
    (file,) = (tmp_path / "out" / "runs").rglob("run.json")
    run = json.loads(file.read_text())
    assert run["origin"] == {"cohort": "small", "job": row["job"], "factors": {"age_months": 18}}
    assert run["settings"]["seed"] == 4


def test_a_folder_with_anything_else_in_it_is_left_alone(cohort, here, tmp_path):
    (tmp_path / "out" / "results").mkdir(parents=True)
    for do in (lambda out: cohort().run(out, here), lambda out: plan(cohort(), out)):
        with pytest.raises(MimocError, match="not the folder of a cohort; name a new or empty folder"):
            do(tmp_path / "out")
    with pytest.raises(MimocError, match=r"cohort\.yaml: this is a file"):
        cohort().run(tmp_path / "cohort.yaml", here)
    assert [*(tmp_path / "out").rglob("*")] == [tmp_path / "out" / "results"]


def test_a_folder_that_cannot_be_written_is_one_clear_error(write, tmp_path, invoke):
    cohort = write()
    (tmp_path / "out").mkdir()
    assert invoke("cohort", "run", cohort, "-o", "/proc/out")[::2] == (
        2,
        "/proc/out: cannot be written (No such file or directory); choose another folder\n",
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"index": 3, "of": 3}, "there is no share 3 of 3"),
        ({"on": "moon"}, "'moon' is not a place to run a cohort on; choose from local"),
    ],
)
def test_a_share_or_a_place_that_does_not_exist_is_refused(cohort, tmp_path, options, message):
    with pytest.raises(MimocError, match=message):
        cohort().run(tmp_path / "out", **options)
    assert not (tmp_path / "out").exists()


def test_processes_that_do_jobs_use_one_thread_each():
    assert {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"} <= PINNED.keys()
    assert set(PINNED.values()) == {"1"}


NUMBER = 3


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    base = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"vestibular": {}}}
    keys = {"cohort": "small", "base": base, "children": {"draw": NUMBER}, "do": ["build"]}
    study, store = Cohort({"mimoc": 1, **keys}), Store(tmp_path_factory.mktemp("cohort"))
    store.create("small")
    run_jobs(study.jobs(), store)
    return study, store


def test_a_thousand_infants_take_less_than_100_megabytes(built):
    study, store = built
    shared = size_bytes(store.folder / "assets")
    each = (size_bytes(store.folder) - shared) / NUMBER
    assert shared + 1000 * each < 100e6
    links = {path.name: path.stat().st_nlink for path in store.bundle_folder(study.jobs()[0]).glob("assets/*.png")}
    assert len(links) > 5
    assert set(links.values()) == {NUMBER + 1}


def test_a_stored_bundle_opens_with_plain_mujoco_and_is_whole(built):
    study, store = built
    for job, spec in zip(study.jobs(), study.specs, strict=True):
        model = mujoco.MjModel.from_xml_path(str(store.bundle_folder(job) / "scene.xml"))
        alone = mimoc.build(spec.with_(body={"skin": False}))
        assert store.read_bundle(job).manifest == alone.manifest
        assert mimoc.make(store.read_bundle(job)).unwrapped.model.nq == model.nq


def test_the_provenance_of_a_stored_bundle_is_worked_out_again(built):
    study, store = built
    lean, whole = store.read_bundle(study.jobs()[0]), mimoc.build(study.specs[0])
    assert "provenance.json" not in lean.files
    key = "body.left_foot.mass"
    assert explain.explain(lean, key).lines == explain.explain(whole, key).lines


def test_a_stored_bundle_is_not_explained_by_another_version(built, monkeypatch):
    study, store = built
    lean = store.read_bundle(study.jobs()[0])
    monkeypatch.setattr("mimoc.compiler.building.Builder.files", {"infant.xml": b"another"})
    with pytest.raises(BundleError, match="builds another infant"):
        explain.contents(lean)


TASKS_OWN = "def nothing(work):\n    return {}\n"
MANY = {"python": {"function": "own:nothing", "seeds": "0:7"}}


class Cluster:
    """A cluster that does each task when it is asked how tasks have ended."""

    def __init__(self, store, room=1000, dies_at=(), never_begins=0, cancels=False, refuses=0):
        self.store, self.room, self.dies_at = store, room, set(dies_at)
        self.never_begins, self.cancels, self.refuses = never_begins, cancels, refuses
        self.queue, self.submitted, self.most, self.cancelled = {}, [], 0, False

    def submit(self, tasks):
        if self.refuses and self.submitted:
            self.refuses -= 1
            raise RefusedError("no more")
        names = [f"{len(self.submitted) + number}" for number in range(len(tasks))]
        self.submitted += [[job.seed for job in task] for task in tasks]
        self.queue |= dict(zip(names, tasks, strict=True))
        self.most = max(self.most, len(self.queue))
        return names

    def ended(self):
        name = next(iter(self.queue))
        return {name: self.do(self.queue.pop(name))}

    def do(self, task):
        if self.cancels:
            return End("the task was cancelled", on_purpose=True)
        if self.never_begins:
            self.never_begins -= 1
            return End("the node is broken")
        for job in task:
            if job.seed in self.dies_at:
                self.store.log(job).parent.mkdir(exist_ok=True)
                self.store.log(job).touch()
                return End("the task was killed")
            run_jobs([job], self.store)
        return End("the task has ended")

    def cancel(self):
        self.cancelled = True


@pytest.fixture
def study(cohort, tmp_path):
    (tmp_path / "own.py").write_text(TASKS_OWN)
    store = Store(tmp_path / "out")
    store.create("small")
    return cohort(do=[MANY]).jobs(), store


def errors(jobs, store):
    return {job.seed: store.read(job).error for job in jobs if not store.read(job).ok}


def test_all_jobs_are_done_with_no_more_tasks_at_once_than_there_is_room_for(study):
    jobs, store = study
    calls, cluster = [], Cluster(store, room=2)
    do_on(cluster, tasks_of(jobs, 2), store, calls.append)
    assert (errors(jobs, store), cluster.most, calls) == ({}, 2, [2, 4, 6, 7])
    assert not cluster.cancelled


def test_a_job_that_kills_its_task_twice_has_failed_and_the_others_of_the_task_have_not(study):
    jobs, store = study
    cluster = Cluster(store, dies_at=[1, 4])
    do_on(cluster, tasks_of(jobs, 5), store, lambda done: None)
    reason = "the task was killed, 2 times; see the log"
    assert errors(jobs, store) == {1: reason, 4: reason}
    assert cluster.submitted == [[0, 1, 2, 3, 4], [5, 6], [1, 2, 3, 4], [2, 3, 4], [4]]


def test_a_task_that_ends_before_its_first_job_is_begun_once_more(study):
    jobs, store = study
    do_on(Cluster(store, never_begins=1), tasks_of(jobs, 7), store, lambda done: None)
    assert errors(jobs, store) == {}


def test_the_jobs_of_a_task_that_never_begins_have_failed(study):
    """So a cluster whose nodes are all broken is not asked for ever."""
    jobs, store = study
    cluster = Cluster(store, never_begins=1000)
    do_on(cluster, tasks_of(jobs, 4), store, lambda done: None)
    assert set(errors(jobs, store).values()) == {"the node is broken before its first job, 2 times"}
    assert len(cluster.submitted) == 4


def test_what_somebody_has_cancelled_is_not_begun_again(study):
    jobs, store = study
    cluster = Cluster(store, cancels=True)
    do_on(cluster, tasks_of(jobs, 7), store, lambda done: None)
    assert (len(errors(jobs, store)), len(cluster.submitted)) == (7, 1)


def test_a_cluster_that_takes_no_more_tasks_is_asked_again_when_some_have_ended(study):
    jobs, store = study
    do_on(Cluster(store, room=4, refuses=2), tasks_of(jobs, 1), store, lambda done: None)
    assert errors(jobs, store) == {}


def test_a_cluster_that_takes_no_tasks_at_all_is_an_error(study):
    jobs, store = study
    cluster = Cluster(store, refuses=1)
    cluster.submitted.append([])
    with pytest.raises(RefusedError, match="no more"):
        do_on(cluster, tasks_of(jobs, 1), store, lambda done: None)


def test_ctrl_c_cancels_all_tasks(study):
    jobs, store = study
    cluster = Cluster(store)

    def stop(done):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        do_on(cluster, tasks_of(jobs, 1), store, stop)
    assert cluster.cancelled


def test_long_steps_are_tasks_of_their_own_and_short_ones_share_a_task(cohort):
    jobs = cohort(do=[{"run": {"seeds": "0:60"}}, {"train": {"seeds": "0:2"}}]).jobs()
    assert [len(task) for task in tasks_of(jobs, None)] == [50, 10, 1, 1]
    assert [len(task) for task in tasks_of(jobs, 25)] == [25, 25, 10, 2]


@pytest.mark.parametrize(("on", "library"), [("slurm", "submitit"), ("ray", "ray")])
def test_a_library_that_is_missing_is_named_and_nothing_is_written(cohort, tmp_path, monkeypatch, on, library):
    monkeypatch.delitem(sys.modules, f"mimoc.studies.cohorts.{on}", raising=False)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(MimocError, match=rf"{library} is not installed; run: pip install 'mimoc\[{on}\]'"):
        cohort().run(tmp_path / "out", on)
    assert not (tmp_path / "out").exists()


def test_an_option_of_another_engine_is_refused(cohort, tmp_path):
    with pytest.raises(MimocError, match="'partition' is not a setting of '--on local'; choose from processes"):
        cohort().run(tmp_path / "out", partition="long")
    assert not (tmp_path / "out").exists()
