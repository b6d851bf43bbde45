"""Folders of cohorts that are changed by chance, and used: reported on, counted, gathered in a table, gone on with."""

from collections.abc import Callable, Iterable
from pathlib import Path
from shutil import copytree

import numpy as np
from fuzz.fuzzing import Fuzzer
from fuzz.honest_cohorts import ENGINE, MODULE, in_this_process
from fuzz.mutations import pick, spoil

import mimoc
from mimoc.base.errors import MimocError
from mimoc.schema.source import dump
from mimoc.studies.cohorts.cohort import Cohort, plan
from mimoc.studies.cohorts.store import Result, Store

STUDY = {
    "mimoc": 1,
    "cohort": "spring",
    "base": {"mimoc": 1, "name": "infant", "age_months": 9, "body": {"skin": False}},
    "children": [{"sex": "female", "length_percentile": 30, "weight_kg": 8}, {"length_cm": 72}],
    "vary": {"scene.pose": ["supine", "prone"]},
    "do": ["build", {"run": {"steps": 3}}, {"python": "own_code:probe"}],
}
Way = Callable[[], object]
LEFT = 3  # Jobs that are still to be done.


def prepare(folder: Path) -> Path:
    (folder / "own_code.py").write_text(MODULE)
    (folder / "cohort.yaml").write_text(dump(STUDY))
    study, store = Cohort(folder / "cohort.yaml"), Store(folder / "out")
    with in_this_process():
        study.run(store.folder, ENGINE)
    study.table(store.folder)
    *_, failed, last = study.jobs()
    store.write_bundle(last, mimoc.build(study.specs[0]))  # It is not looked at, but may be in the way.
    for job in study.jobs()[-LEFT:]:
        store.forget(job)
    store.write(failed, Result("failed", {}, {"mimoc": "1"}, "it is late", 1.0))
    store.log(failed).write_text("late\n")
    return folder


def attempt(prepared: Path, generator: np.random.Generator, folder: Path) -> None:
    place = copied(prepared, folder)
    spoil(generator, place / "out", folder.parent / "outside")
    known = ways(place)
    use(pick(generator, known) for _ in range(3))


def copied(prepared: Path, folder: Path) -> Path:
    return Path(copytree(prepared, folder / "cohort"))


def ways(place: Path) -> tuple[Way, ...]:
    study, out, page = Cohort(place / "cohort.yaml"), place / "out", place / "page.html"
    built = [job for job in study.jobs() if job.step == "build"]
    return (
        lambda: mimoc.report(out, page),
        lambda: mimoc.report(out, page, cohort=study),
        lambda: study.table(out),
        lambda: plan(study, out),
        lambda: study.run(out, ENGINE),
        lambda: study.retry(out, ENGINE),
        lambda: [Store(out).read_bundle(job) for job in built],
    )


def use(chosen: Iterable[Way]) -> None:
    refused = None
    with in_this_process():
        for way in chosen:
            try:
                way()
            except MimocError as error:
                refused = error
    if refused:
        raise refused


FUZZER = Fuzzer(prepare, attempt, short=8)
