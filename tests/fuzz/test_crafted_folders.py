"""Any value in any place of the files of cohorts and trainings is used, or refused in one line."""

import csv
import io
import json
from collections.abc import Callable, Iterator
from copy import deepcopy
from functools import partial
from itertools import product
from typing import Any

import pytest
from fuzz import cohorts, trainings
from fuzz.crafted_policies import packed, unpacked
from fuzz.mutations import TEXTS, VALUES
from support.full import full_but

import mimoc
from mimoc.base.errors import MimocError, TrainingError
from mimoc.studies.cohorts import Cohort
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
    """A copy of the folder of a training run."""
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
    """Yield the keys that lead to each value in plain data."""
    for key, value in data.items() if isinstance(data, dict) else ():
        yield (*above, key)
        yield from places(value, *above, key)


def is_refused(use: Callable[[], object]) -> bool:
    """Return whether something raises an error, which must be one line of text."""
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
