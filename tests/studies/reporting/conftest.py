"""Pages to look at, each made once, and what reads them as a browser does."""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from html.parser import HTMLParser
from pathlib import Path

import pytest
from support import store
from support.worlds import placed

import mimoc
from mimoc.base.errors import RenderingError
from mimoc.studies.cohorts.cohort import Cohort
from mimoc.studies.cohorts.store import Result, Store
from mimoc.studies.reporting import infant
from mimoc.training.curve import Curve, CurvePoint
from mimoc.training.run_folder import open_run_folder
from mimoc.training.settings import TrainingSettings

VOID = {"meta", "img", "br", "link"}
SPEC = {
    "mimoc": 1,
    "name": "small_one",
    "age_months": 9,
    "body": {"individual": {"sex": "female", "length_percentile": 25}},
    "senses": {"proprioception": {}, "vestibular": {}, "touch": {"regions": ["hands"]}},
    "delays": {"preset": "physiological"},
    "noise": {"proprioception_deg": 1.5},
}
STUDY = {
    "mimoc": 1,
    "cohort": "spring",
    "base": {"mimoc": 1, "name": "infant", "age_months": 9},
    "children": {"draw": 3, "seed": 1},
    "vary": {"age_months": [3, 9]},
    "do": ["build", {"run": {"policy": "random", "steps": 10}}],
}
FAILURE = "the floor <b>gave way</b>"


@dataclass
class Seen(HTMLParser):
    """What a page holds; a page whose elements do not nest is refused."""

    html: str
    text: str = ""
    tags: list[tuple[str, dict[str, str | None]]] = field(default_factory=list)
    rows: list[list[str]] = field(default_factory=list)

    def __post_init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self._open: list[str] = []
        self.feed(self.html)
        self.close()
        assert self._open == []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self._open.append(tag)
        if tag == "tr":
            self.rows.append([])
        elif tag in ("td", "th"):
            self.rows[-1].append("")

    def handle_endtag(self, tag: str) -> None:
        assert self._open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data
        if any(tag in self._open for tag in ("td", "th")) and "svg" not in self._open and "a" not in self._open[-1:]:
            self.rows[-1][-1] = f"{self.rows[-1][-1]}{data}".strip()

    def attributes(self, name: str) -> list[str]:
        return [str(found[name]) for _, found in self.tags if name in found]

    def row(self, first: str) -> list[str]:
        (found,) = (row for row in self.rows if row[:1] == [first])
        return found


@pytest.fixture(scope="session")
def see() -> Callable[[Path], Seen]:
    read = cache(Seen)
    return lambda page: read(page.read_text(encoding="utf-8"))


@pytest.fixture
def without_opengl(monkeypatch) -> None:
    """Draw no portraits, which takes most of a page's time."""
    monkeypatch.setattr(infant, "portrait", _no_opengl)


@pytest.fixture(scope="session")
def small_one() -> mimoc.Bundle:
    return store.built(SPEC)


@pytest.fixture(scope="session")
def page(small_one, tmp_path_factory) -> Path:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(infant, "portrait", _no_opengl)
        return mimoc.report(small_one, tmp_path_factory.mktemp("pages") / "infant.html")


@pytest.fixture(scope="session")
def run_page(run, tmp_path_factory) -> Path:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(infant, "portrait", _no_opengl)
        return mimoc.report(run, tmp_path_factory.mktemp("pages") / "run.html")


@pytest.fixture(scope="session")
def pair(tmp_path_factory) -> mimoc.WorldBundle:
    """Return two infants who sit so near that their feet touch; one is weak."""
    sitting = {**SPEC, "scene": {"pose": "sitting"}}
    weak = {**sitting, "age_months": 6, "impairments": {"weakness": {"right_arm": 0.1}}}
    return placed({"anna": sitting, "ben": weak}, {"y_cm": 22, "yaw_deg": -90}, {"y_cm": -22, "yaw_deg": 90})


@pytest.fixture(scope="session")
def world_page(pair, tmp_path_factory) -> Path:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(infant, "world_portrait", _no_opengl)
        return mimoc.report(pair, tmp_path_factory.mktemp("pages") / "world.html", beside="healthy")


@pytest.fixture(scope="session")
def cohort_page(cohort, tmp_path_factory) -> Path:
    return mimoc.report(cohort, tmp_path_factory.mktemp("pages") / "cohort.html")


@pytest.fixture(scope="session")
def run(small_one, tmp_path_factory) -> Path:
    folder = tmp_path_factory.mktemp("runs") / "run"
    settings = TrainingSettings.choose("ppo", 4096, 3, 2, 1024, {"gamma": 0.9})
    rows = [
        CurvePoint(1024, 5, -2.0, 0.0, 100.0, float("nan"), 1.5),
        CurvePoint(2048, 7, 1.25, 0.375, 80.0, 0.5, 3.0),
    ]
    with open_run_folder(folder, settings, small_one, force=False) as opened:
        opened.write("curve.csv", Curve(tuple(rows)).to_csv().encode())
    return folder


@pytest.fixture(scope="session")
def study() -> Cohort:
    return Cohort(STUDY)


@pytest.fixture(scope="session")
def cohort(study, small_one, tmp_path_factory) -> Path:
    """Return the folder of that cohort: all is built, half of the runs are done, and one of them has failed."""
    store = Store(tmp_path_factory.mktemp("cohorts") / "spring")
    store.create("spring")
    versions = {"mimoc": "0.1.0"}
    built = [job for job in study.jobs() if job.step == "build"]
    runs = [job for job in study.jobs() if job.step == "run"]
    for number, job in enumerate(built):
        store.write(job, Result("ok", {"length_cm": 60.0 + number, "bundle": "sha256:1"}, versions))
    store.write_bundle(built[0], small_one)
    store.write(runs[0], Result("ok", {"length_cm": 60.0, "joint_speed_rad_s": 0.5, "unstable": False}, versions))
    store.write(runs[1], Result("ok", {"length_cm": 61.0, "joint_speed_rad_s": 0.75, "unstable": False}, versions))
    store.write(runs[2], Result("failed", {}, versions, FAILURE))
    return store.folder


def _no_opengl(*_: object, **__: object) -> None:
    raise RenderingError("no OpenGL here")
