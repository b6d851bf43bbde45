"""Tasks of several jobs, on a cluster that may kill them."""

import sys

import pytest

from mimoc.base.errors import MimocError
from mimoc.studies.cohorts.engines import End, RefusedError, do_on, tasks_of
from mimoc.studies.cohorts.run_jobs import run_jobs
from mimoc.studies.cohorts.store import Store

OWN = "def nothing(work):\n    return {}\n"
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
    """Return seven jobs that do nothing, and a folder for their results."""
    (tmp_path / "own.py").write_text(OWN)
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
    monkeypatch.delitem(sys.modules, f"mimoc.studies.cohorts.engines.{on}", raising=False)
    monkeypatch.setitem(sys.modules, library, None)
    with pytest.raises(MimocError, match=rf"{library} is not installed; run: pip install 'mimoc\[{on}\]'"):
        cohort().run(tmp_path / "out", on)
    assert not (tmp_path / "out").exists()


def test_an_option_of_another_engine_is_refused(cohort, tmp_path):
    with pytest.raises(MimocError, match="'partition' is not a setting of '--on local'; choose from processes"):
        cohort().run(tmp_path / "out", partition="long")
    assert not (tmp_path / "out").exists()
