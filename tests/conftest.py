"""Infants of any age and a wheel, made once, and the figures of MIMo's published body."""

import csv
import fcntl
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import cache
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import settings

os.environ["MIMOC_PLUGINS"] = "none"  # Before mimoc looks for any: tests that need plug-ins name them.

from mimoc.base.errors import problem_of_loading_mujoco

try:
    import mujoco
except Exception as error:
    pytest.exit(problem_of_loading_mujoco(error) or f"MuJoCo cannot be imported: {error!r}", returncode=2)

from support import store
from support.full import full_but, needs_extras

import mimoc

pytest_plugins = [
    "support.commands",
    "support.cpu_times",
    "support.drawing",
    "support.registering",
    "support.running",
]

settings.register_profile("mimoc", deadline=None, derandomize=True)
settings.load_profile("mimoc")


def pytest_configure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        store.open_folder()


LEFT_OUT = "full", "extras"  # Marks of tests that run only if they are asked for by `-m`, as `make test-all` does.


def pytest_ignore_collect(collection_path: Path, config: pytest.Config) -> bool | None:
    """Import no file whose libraries may be missing, unless its tests are asked for."""
    return True if needs_extras(collection_path) and "extras" not in config.getoption("markexpr") else None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    asked = config.getoption("markexpr")
    marks = [mark for mark in LEFT_OUT if mark not in asked]
    for item in items:
        if needs_extras(item.path):
            item.add_marker("extras")
    if not asked or "full" in asked:
        _mark_most_cases_full(items)
    left_out = {item for item in items if any(map(item.get_closest_marker, marks))}
    config.hook.pytest_deselected(items=list(left_out))
    items[:] = [item for item in items if item not in left_out]


CASES = 3  # Cases of a test that `make test` runs: the first, the one in the middle and the last.


def _mark_most_cases_full(items: list[pytest.Item]) -> None:
    tests: dict[str, list[pytest.Item]] = {}
    for item in items:
        if not any(map(item.get_closest_marker, LEFT_OUT)):
            tests.setdefault(item.nodeid.partition("[")[0], []).append(item)
    for cases in tests.values():
        kept = {round(place * (len(cases) - 1) / (CASES - 1)) for place in range(CASES)}
        for place, case in enumerate(cases):
            if place not in kept:
                case.add_marker("full")


def pytest_sessionfinish(session: pytest.Session, exitstatus: int) -> None:
    """Take a part of the tests of which all are left out for one without tests, not for a failure."""
    if exitstatus == pytest.ExitCode.NO_TESTS_COLLECTED and not session.config.getoption("markexpr"):
        session.exitstatus = pytest.ExitCode.OK
        print("\nnone of these tests runs but by `make test-all`, or -m 'full or extras'")


def pytest_unconfigure(config: pytest.Config) -> None:
    if not hasattr(config, "workerinput"):
        store.remove_folder()


TOGETHER = ("tests/runtime/device/",)
"""Folders whose tests run in one worker, so that kernels are compiled once where nothing is cached yet."""


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log):
    if config.getvalue("dist") != "loadfile":
        return None
    from xdist.scheduler.loadfile import LoadFileScheduling

    class ByFileOrFolder(LoadFileScheduling):
        def _split_scope(self, nodeid: str) -> str:
            return next((folder for folder in TOGETHER if nodeid.startswith(folder)), super()._split_scope(nodeid))

    return ByFileOrFolder(config, log)


SENSES = {"proprioception": {}, "vestibular": {}}
AGES_MONTHS = (*(quarter / 4 for quarter in range(12)), *range(3, 25))
"""Every quarter of a month while children grow fastest, and then every month."""
FEW_AGES_MONTHS = (*AGES_MONTHS[:7], 3, 6, 12, 24)
"""The same at first, when feet become lower while children grow, and then few."""
BODIES = {"mitten": ("mitten", False), "five_finger": ("five_finger", True)}
"""Hands and chest joint: between them, everything a body can have."""
CHEST = "robot:chest_"  # How the joints begin that a body with a rigid chest does not have.
CHECKOUT = Path(__file__).resolve().parents[1]
REFERENCE = CHECKOUT / "tests" / "reference"


@dataclass(frozen=True)
class Infant:
    """A compiled infant that stands straight, all joints at zero; shared, so never to be written to."""

    age_months: float
    hands: str
    model: mujoco.MjModel = field(repr=False)
    data: mujoco.MjData = field(repr=False)

    def geoms(self, *bodies: str) -> list[str]:
        """Return the geoms of some bodies, without what only shows."""
        ids = [self.model.body(body).id for body in bodies]
        geoms = map(self.model.geom, range(self.model.ngeom))
        return [geom.name for geom in geoms if geom.bodyid[0] in ids and geom.group[0] == 0]

    def limb(self, body: str) -> list[str]:
        """Return the geoms of a body and of everything attached to it, without what only shows."""
        limb = {self.model.body(body).id}
        for index in range(self.model.nbody):
            limb |= {index} if self.model.body_parentid[index] in limb else set()
        return self.geoms(*(self.model.body(index).name for index in sorted(limb)))

    def span_m(self, direction: np.ndarray, geoms: list[str]) -> tuple[float, float]:
        """Return how far some geoms reach against and along a unit vector of the world."""
        pairs = [(self.data.geom(geom).xpos @ direction, self._reach_m(geom, direction)) for geom in geoms]
        return min(at - reach for at, reach in pairs), max(at + reach for at, reach in pairs)

    def _reach_m(self, name: str, direction: np.ndarray) -> float:
        x, y, z = np.abs(self.data.geom(name).xmat.reshape(3, 3).T @ direction)
        size, kind = self.model.geom(name).size, self.model.geom(name).type[0]
        if kind == mujoco.mjtGeom.mjGEOM_BOX:
            return float(size @ (x, y, z))
        if kind == mujoco.mjtGeom.mjGEOM_CYLINDER:
            return float(size[0] * np.hypot(x, y) + size[1] * z)
        if kind == mujoco.mjtGeom.mjGEOM_ELLIPSOID:
            return float(np.linalg.norm(size * (x, y, z)))
        return float(size[0] + size[1] * z)


def spec_of(age_months: float, **body: Any) -> mimoc.InfantSpec:
    """Return the spec of a child of an age, the average one if nothing else is said of its body."""
    spec = {"mimoc": 1, "name": "infant", "age_months": age_months, "body": body, "senses": SENSES}
    return mimoc.InfantSpec.model_validate(spec)


def _bundle(age_months: float, hands: str = "mitten", chest_joint: bool = False) -> mimoc.Bundle:
    return store.built(spec_of(age_months, hands=hands, chest_joint=chest_joint))


@cache
def _infant(age_months: float, hands: str = "mitten", chest_joint: bool = False) -> Infant:
    return _compile(spec_of(age_months, hands=hands, chest_joint=chest_joint))


def _compile(spec: mimoc.InfantSpec) -> Infant:
    model = store.compiled(spec)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return Infant(spec.age_months, spec.body.hands, model, data)


@pytest.fixture(scope="session")
def bundle_at() -> Callable[..., mimoc.Bundle]:
    """Return the bundle of the average child of an age, its hands and its chest joint."""
    return _bundle


@pytest.fixture(scope="session")
def infant_at() -> Callable[..., Infant]:
    return _infant


@pytest.fixture(scope="session")
def infant_with() -> Callable[..., Infant]:
    """Return the compiled child of nine months, or of another age, with whatever a spec can say of its body."""
    return lambda age_months=9, **body: _compile(spec_of(age_months, **body))


@pytest.fixture(
    scope="session",
    params=full_but(product(BODIES, [FEW_AGES_MONTHS]), product(BODIES, [AGES_MONTHS])),
    ids=lambda param: f"{param[0]}-{len(param[1])} ages",
)
def infants(request) -> list[Infant]:
    """Return the average child with mittens, then with everything, at few of `AGES_MONTHS` or all."""
    body, ages_months = request.param
    return [_infant(age_months, *BODIES[body]) for age_months in ages_months]


@pytest.fixture(scope="session", params=product(("mitten", "five_finger"), (False, True)), ids=str)
def hands_and_chest(request) -> tuple[str, bool]:
    """Return each kind of hands, with and without the joints of the chest."""
    return request.param


@pytest.fixture(scope="session")
def model(hands_and_chest) -> mujoco.MjModel:
    """Return the compiled average child of 18 months by the published law: the body that MIMo published."""
    hands, chest_joint = hands_and_chest
    return _compile(spec_of(18, hands=hands, chest_joint=chest_joint).with_(development="published")).model


@pytest.fixture(scope="session")
def published(reference, hands_and_chest) -> Callable[[str], list[dict[str, str]]]:
    return lambda table: reference(table, *hands_and_chest)


@pytest.fixture(scope="session")
def reference() -> Callable[..., list[dict[str, str]]]:
    """Return a table of one of MIMo's published bodies, with or without the two joints of the chest."""

    def rows(table: str, hands: str = "mitten", chest_joint: bool = False) -> list[dict[str, str]]:
        with (REFERENCE / hands / f"{table}.csv").open() as file:
            found = list(csv.DictReader(file))
        return [row for row in found if chest_joint or not row.get("joint", row.get("name", "")).startswith(CHEST)]

    return rows


@pytest.fixture(scope="session")
def wheel(tmp_path_factory) -> Path:
    """Return a wheel that was built from the checkout, once for all processes that test."""
    folder = tmp_path_factory.getbasetemp()
    folder = (folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder) / "wheel"
    folder.mkdir(exist_ok=True)
    with (folder / "lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not list(folder.glob("*.whl")):
            build = ["-m", "build", "--wheel", "--no-isolation", "--outdir", str(folder), str(CHECKOUT)]
            subprocess.run([sys.executable, *build], check=True, capture_output=True)
    (found,) = folder.glob("*.whl")
    return found


@pytest.fixture(scope="session")
def kernels_compiled_quickly() -> Iterator[None]:
    """Compile Warp's kernels for the CPU without optimising them, in half the time; for a GPU, that is unsafe."""
    import warp as wp
    from support.devices import WARP_DEVICE

    kept = wp.config.optimization_level
    if WARP_DEVICE == "cpu":
        wp.config.optimization_level = 0
    yield
    wp.config.optimization_level = kept
