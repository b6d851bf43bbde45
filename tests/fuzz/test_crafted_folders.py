"""Cohorts, trainings and policies made to do harm are used or refused in one line, and nothing outside is touched.

Any value stands in any place of their files; folders are full of links to files outside, or of pipes; no code of a
policy runs.
"""

import csv
import io
import json
import os
import signal
from collections.abc import Callable, Iterator
from contextlib import suppress
from copy import deepcopy
from functools import partial
from itertools import product
from pathlib import Path
from shutil import rmtree
from types import ModuleType
from typing import Any

import pytest
from fuzz import cohorts, policies, trainings
from fuzz.crafted_policies import CRAFTED, packed, ran, unpacked
from fuzz.fuzzing import Canaries, is_clear
from fuzz.mutations import TEXTS, VALUES
from support.full import full_but

import mimoc
from mimoc.base.errors import MimocError, PolicyError, TrainingError
from mimoc.studies.cohorts.cohort import Cohort
from mimoc.studies.cohorts.store import MARK, Store, finished_jobs
from mimoc.training.checkpoint import read_progress
from mimoc.training.run_folder import CURVE, RUN, STATE, read_training_run


@pytest.fixture
def cohort(tmp_path):
    """A folder with the file of a cohort and its folder, in which most jobs are done."""
    return cohorts.prepare(tmp_path)


@pytest.fixture(scope="module")
def trained(tmp_path_factory):
    """The folder of a training run, its infant and an environment, which are only read."""
    return trainings.prepare(tmp_path_factory.mktemp("trained"))


@pytest.fixture
def run(trained, tmp_path):
    return trainings.copied(trained, tmp_path)


def crafted(data: Any) -> Iterator[Any]:
    """Yield plain data with another value in each place; without each key, and with another one beside it."""
    for *above, last in places(data):
        for value in VALUES:
            yield changed(data, above, {last: value})
        yield changed(data, above, {last: ...})
        yield changed(data, above, {"x": 0})


def changed(data: Any, above: list[str], items: dict[str, Any]) -> Any:
    """Return a copy of plain data with other items in one place; without those that are an ellipsis."""
    data = inside = deepcopy(data)
    for key in above:
        inside = inside[key]
    inside.update(items)
    for key in [key for key, value in items.items() if value is ...]:
        del inside[key]
    return data


def places(data: Any, *above: str) -> Iterator[tuple[str, ...]]:
    for key, value in data.items() if isinstance(data, dict) else ():
        yield (*above, key)
        yield from places(value, *above, key)


def is_refused(use: Callable[[], object]) -> bool:
    error = None
    try:
        use()
    except MimocError as raised:
        error = str(raised)
    assert error is None or error.isprintable()
    return error is not None


@pytest.mark.parametrize("every", full_but([4], [1]), ids=["every fourth", "all"])
def test_results_of_a_cohort_with_any_value_are_used_or_left_out(cohort, every):
    """Each file has a fault of its own at a time, so that a page and a table see all of them."""
    out, study = cohort / "out", Cohort(cohort / "cohort.yaml")
    files = sorted((out / "results").glob("*/*.json"))
    faults = [list(crafted(json.loads(file.read_bytes())))[place :: len(files)] for place, file in enumerate(files)]
    numbers = set[int]()
    for number in range(0, max(map(len, faults)), every):
        for file, known in zip(files, faults, strict=True):
            file.write_text(json.dumps(known[number % len(known)]))
        jobs, damaged = finished_jobs(Store(out))
        assert len(jobs) + len(damaged) == len(files)
        numbers.add(len(jobs))
        mimoc.report(out, cohort / "page.html")
        study.table(out)
    assert len(numbers) > 2


def test_a_mark_of_a_cohort_with_any_value_is_used_or_refused(cohort):
    mark = cohort / "out" / MARK
    tried = list(crafted(json.loads(mark.read_bytes())))
    refused = 0
    for data in tried:
        mark.write_text(json.dumps(data))
        refused += is_refused(lambda: finished_jobs(Store(cohort / "out")))
    assert 0 < refused < len(tried)


def test_a_description_of_a_training_with_any_value_is_used_or_refused(run, tmp_path):
    """Some of those that can be read are shown on a page, too, which takes longer."""
    readable = []
    honest = json.loads((run / RUN).read_bytes()) | {"origin": {"cohort": "spring", "factors": {"age_months": 9}}}
    honest["settings"] |= {
        "growth": {"schedule": "linear", "grow": [3, 9], "grow_steps": 64},
        "custom": {"task": "a:B"},
    }
    for data in crafted(honest):
        (run / RUN).write_text(json.dumps(data))
        if not is_refused(lambda: read_training_run(run)):
            readable.append(data)
    assert len(readable) > 50
    for data in readable[::20]:
        (run / RUN).write_text(json.dumps(data))
        trainings.use([lambda: mimoc.report(run, tmp_path / "page.html")])


def test_a_curve_with_any_cell_is_used_or_refused(run):
    first, *rows = csv.reader(io.StringIO((run / CURVE).read_text()))
    tried = refused = 0
    for column, text in product(range(len(first)), (*TEXTS, *map(str, VALUES))):
        written = io.StringIO()
        csv.writer(written).writerows([first, *([*row[:column], text, *row[column + 1 :]] for row in rows)])
        (run / CURVE).write_text(written.getvalue())
        tried, refused = tried + 1, refused + is_refused(lambda: read_training_run(run))
    assert 0 < refused < tried


def test_a_checkpoint_with_any_state_is_used_or_refused(run):
    members = unpacked((run / STATE).read_bytes())
    states = crafted(json.loads(members["state.json"]))
    files = [packed(members | {"state.json": json.dumps(data).encode()}) for data in states]
    refused = sum(is_refused(partial(read_progress, file)) for file in files)
    assert 0 < refused < len(files)


def test_training_goes_on_only_with_the_settings_that_are_in_the_folder(trained, run):
    """What differs is said in one line, whatever text it is."""
    data = json.loads((run / RUN).read_bytes())
    (run / RUN).write_text(json.dumps(changed(data, ["settings"], {"custom": {"task": "a\n\0:B"}})))
    with pytest.raises(TrainingError, match=r"started with task a\?\?:B, not unset"):
        mimoc.train(trained[1], run, steps=64, **trainings.SETTINGS)


FILE = b"of somebody else"
Put = Callable[[Path, bool], object]  # Puts something in place of a file, or of a folder.


@pytest.fixture
def outside(tmp_path):
    """A folder of files that nobody may touch, one of which has the name of a log."""
    canaries = Canaries(tmp_path / "outside", {"file": FILE, ".mimoc-left.tmp": FILE})
    yield canaries
    canaries.close()


@pytest.fixture(scope="module")
def prepared(tmp_path_factory):
    made = {kind: kind.prepare(tmp_path_factory.mktemp(kind.__name__)) for kind in (cohorts, trainings)}
    return made.__getitem__


def replace_all(place: Path, depth: int, spared: str, put: Put) -> int:
    """Replace each file and each folder that is so deep in a folder by something else; return how many there are."""
    paths = [path for path in place.rglob("*") if len(path.relative_to(place).parts) == depth and path.name != spared]
    for path in paths:
        replace(path, put)
    return len(paths)


def replace(path: Path, put: Put) -> None:
    is_folder = path.is_dir()
    rmtree(path) if is_folder else path.unlink()
    put(path, is_folder)


def use(kind: ModuleType, begun: Any, tmp_path: Path, depth: int, put: Put) -> Iterator[str]:
    folder = kind.copied(begun, tmp_path)
    if kind is cohorts:
        ways, number = cohorts.ways(folder), replace_all(folder / "out", depth, MARK, put)
    else:
        ways, number = trainings.ways(begun, folder), replace_all(folder, depth, RUN, put)
    assert number or depth > 2
    for way in ways:
        error = ""
        try:
            kind.use([way])
        except MimocError as raised:
            error = str(raised)
        yield error


def untouched(outside: Canaries) -> bool:
    opened = outside.opened()
    contents = {path.name: path.read_bytes() for path in outside.folder.iterdir()}
    outside.opened()  # That was this look.
    return not opened and contents == {"file": FILE, ".mimoc-left.tmp": FILE}


@pytest.mark.parametrize("depth", full_but([1, 4], [2, 3]))
@pytest.mark.parametrize("kind", [cohorts, trainings], ids=["a cohort", "a training"])
def test_nothing_is_read_or_written_through_a_link(kind, depth, prepared, outside, tmp_path):
    """Whatever is done with the folder, in turn, as each may put a file in the place of a link."""

    def link(path: Path, is_folder: bool) -> None:
        path.symlink_to(outside.folder if is_folder else outside.folder / "file")

    for _ in use(kind, prepared(kind), tmp_path, depth, link):
        assert untouched(outside)


@pytest.fixture
def patience():
    before = signal.signal(signal.SIGALRM, signal.default_int_handler)
    signal.alarm(60)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)


def pipe(path: Path, _: bool) -> None:
    os.mkfifo(path)


@pytest.mark.parametrize("depth", full_but([1], [2, 3]))
@pytest.mark.parametrize("kind", [cohorts, trainings], ids=["a cohort", "a training"])
def test_no_pipe_of_many_is_waited_for(kind, depth, prepared, tmp_path, patience):
    assert all(error.isprintable() for error in use(kind, prepared(kind), tmp_path, depth, pipe))


@pytest.mark.parametrize("name", full_but(["bundle", "policy.zip"], ["checkpoints", "state.zip", "curve.csv"]))
def test_no_pipe_in_a_training_is_waited_for(name, prepared, tmp_path, patience):
    """The rest is as it was, so that training goes as far as it can."""
    run = trainings.copied(prepared(trainings), tmp_path)
    replace(run / name, pipe)
    for way in trainings.ways(prepared(trainings), run):
        with suppress(MimocError):
            trainings.use([way])


def test_the_canaries_see_what_is_made_and_listed(outside):
    assert untouched(outside)
    os.listdir(outside.folder)
    assert not untouched(outside)
    (outside.folder / "file").write_bytes(b"")
    assert not untouched(outside)


@pytest.fixture(scope="session")
def honest(tmp_path_factory):
    return policies.prepare(tmp_path_factory.mktemp("trained"))


def refusal(path, env) -> str:
    with pytest.raises(PolicyError) as error:
        policies.use(path, env)
    assert is_clear(error.value)
    return str(error.value)


@pytest.mark.parametrize("name", CRAFTED)
def test_a_crafted_policy_is_refused_in_one_line(name, honest, tmp_path):
    (members, env), (craft, said) = honest, CRAFTED[name]
    changed = dict(members)
    craft(changed)
    (tmp_path / "policy.zip").write_bytes(packed(changed))
    assert said in refusal(tmp_path / "policy.zip", env)
    assert not ran()


def test_a_policy_that_is_a_pipe_is_not_waited_for(honest, tmp_path):
    os.mkfifo(tmp_path / "policy.zip")
    assert "there is no such file" in refusal(tmp_path / "policy.zip", honest[1])


def test_an_honest_policy_is_used(honest, tmp_path):
    (tmp_path / "policy.zip").write_bytes(packed(honest[0]))
    policies.use(tmp_path / "policy.zip", honest[1])
