"""Infants of any age, built and compiled once, and the figures of MIMo's published body."""

import csv
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import settings

import mimoc

settings.register_profile("mimoc", deadline=None, derandomize=True)
settings.load_profile("mimoc")

SENSES = {"proprioception": {}, "vestibular": {}}
QUARTER_MONTHS = tuple(quarter / 4 for quarter in range(97))
CHEST = "robot:chest_"
"""How the joints begin that a body with a rigid chest does not have."""
REFERENCE = Path(__file__).parent / "reference"


@dataclass(frozen=True)
class Infant:
    """A compiled infant that stands straight, all joints at zero; shared, so never to be written to."""

    age_months: float
    model: mujoco.MjModel = field(repr=False)
    data: mujoco.MjData = field(repr=False)

    def geoms(self, *bodies: str) -> list[str]:
        """Return the geoms of some bodies, without what only shows."""
        ids = [self.model.body(body).id for body in bodies]
        geoms = map(self.model.geom, range(self.model.ngeom))
        return [geom.name for geom in geoms if geom.bodyid[0] in ids and geom.group[0] == 0]

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
        return float(size[0] + size[1] * z)


@cache
def _bundle(age_months: float) -> mimoc.Bundle:
    spec = {"mimo": 1, "name": "infant", "age_months": age_months, "senses": SENSES}
    return mimoc.build(mimoc.InfantSpec.model_validate(spec))


@cache
def _infant(age_months: float) -> Infant:
    files = _bundle(age_months).files
    model = mujoco.MjModel.from_xml_string(files["scene.xml"].decode(), assets=dict(files))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return Infant(age_months, model, data)


@pytest.fixture(scope="session")
def bundle_at() -> Callable[[float], mimoc.Bundle]:
    """Return the bundle of the average child of an age."""
    return _bundle


@pytest.fixture(scope="session")
def infant_at() -> Callable[[float], Infant]:
    """Return the compiled average child of an age."""
    return _infant


@pytest.fixture(scope="session")
def infants() -> list[Infant]:
    """Return the average child at every quarter of a month from birth to two years."""
    return [_infant(age_months) for age_months in QUARTER_MONTHS]


@pytest.fixture(scope="session")
def reference() -> Callable[[str], list[dict[str, str]]]:
    """Return a table of MIMo's published mitten body, without the two joints of the chest."""

    def rows(table: str) -> list[dict[str, str]]:
        with (REFERENCE / f"{table}.csv").open() as file:
            return [row for row in csv.DictReader(file) if not row.get("joint", row.get("name", "")).startswith(CHEST)]

    return rows
