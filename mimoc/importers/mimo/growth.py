"""How old the infant of a MIMo scene is: the age at which the published law of growth gives it its sizes."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.body.anatomy import Anatomy
from mimoc.body.grow import grow_average
from mimoc.body.part import REFERENCE_AGE_MONTHS
from mimoc.body.tree import BodyTree, Geom
from mimoc.fits.curves import LAST_MONTH
from mimoc.geometry.solvers import narrowed

PREFIX = "geom:"
"""Of the names of geoms in MIMo's later scenes."""
TOLERANCE_M = 2e-5
"""Difference of sizes up to which they are those of an age: files of MIMo's have four to eleven digits."""
OWN_MASSES = 0.02
"""Relative difference of masses, at the median, up to which a MIMo is the one that has not been grown."""
PRECISION_MONTHS = 1e-5
ROUND_TO = (1.0, 0.5, 0.1, 0.01, 0.001, 0.0001)
"""Ages that people write; the first of these that fits is taken."""

Sizes = Mapping[str, npt.NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class Age:
    """The age of a body, and how well it has the sizes of that age."""

    months: float
    difference_m: float
    """Largest difference of a geom's sizes from those of that age."""
    geom: str
    """Name of that geom."""
    is_ungrown: bool
    """Whether it is MIMo's own model, which was made for 18 months and not grown."""

    @property
    def fits(self) -> bool:
        """Whether these are the sizes of that age."""
        return self.difference_m <= TOLERANCE_M


def recognise_age(model: mujoco.MjModel, anatomy: Anatomy) -> Age:
    """Return the age of MIMo in a compiled scene.

    It is the age whose geoms differ least, as the sum of squares over all sizes that both have, from those in the
    scene; MIMo's own model, which is recognised by its masses, is 18 months old.
    """

    @cache
    def grown(months: float) -> BodyTree:
        return grow_average(months, anatomy)

    sizes = geom_sizes(model, grown(REFERENCE_AGE_MONTHS))

    def error(months: float) -> float:
        return sum(float(np.sum(change**2)) for change in _changes(sizes, grown(months)).values())

    def largest(months: float) -> tuple[float, str]:
        changes = _changes(sizes, grown(months)).items()
        return max(((float(np.max(np.abs(change))), name) for name, change in changes), default=(0.0, ""))

    def errors(months: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        return np.array([[error(float(month)) for month in row] for row in months])

    if not sizes:
        return Age(REFERENCE_AGE_MONTHS, math.inf, "", is_ungrown=False)
    (low,), (high,) = narrowed(errors, np.array([0.0]), np.array([LAST_MONTH]), PRECISION_MONTHS)
    nearest = [round(round(float(low + high) / 2 / unit) * unit, 4) for unit in ROUND_TO]
    months = next((months for months in nearest if largest(months)[0] <= TOLERANCE_M), None)
    ungrown = months is None and _is_ungrown(model, anatomy)
    if months is None:
        months = REFERENCE_AGE_MONTHS if ungrown else nearest[ROUND_TO.index(0.1)]
    return Age(int(months) if months == int(months) else months, *largest(months), ungrown)


def geom_sizes(model: mujoco.MjModel, tree: BodyTree) -> Sizes:
    """Return the sizes of the geoms of a compiled scene that are MIMo's, by mimoc's names."""
    return {name: np.array(model.geom_size[geom]) for name, geom in mimos_geoms(model, tree).items()}


def mimos_geoms(model: mujoco.MjModel, tree: BodyTree) -> dict[str, int]:
    """Return the number of each of MIMo's geoms in a compiled scene, by mimoc's names.

    Names of geoms have a prefix in later scenes, and many have none in earlier ones: those are known by their place.
    """
    geoms = tree.geoms
    return {name: geom for geom in range(model.ngeom) if (name := _known_name(model, geom, geoms))}


def _known_name(model: mujoco.MjModel, geom: int, geoms: Mapping[str, Geom]) -> str:
    body = model.geom_bodyid[geom]
    name = model.geom(geom).name.removeprefix(PREFIX) or f"{model.body(body).name}{geom - model.body_geomadr[body] + 1}"
    known = next((known for known in (name, f"{name}1") if known in geoms), "")
    kind = mujoco.mjtGeom(model.geom_type[geom]).name.removeprefix("mjGEOM_").lower()
    return known if known and geoms[known].type == kind and geoms[known].mass_kg else ""


def _changes(sizes: Sizes, tree: BodyTree) -> Sizes:
    """Return the differences of sizes from those of a body."""
    geoms = tree.geoms
    return {name: size[: len(geoms[name].size_m)] - geoms[name].size_m for name, size in sizes.items()}


def _is_ungrown(model: mujoco.MjModel, anatomy: Anatomy) -> bool:
    """Return whether limbs have the masses of MIMo's own model."""
    ratios = list(_mass_ratios(model, anatomy))
    return bool(ratios) and abs(float(np.median(ratios)) - 1) < OWN_MASSES


def _mass_ratios(model: mujoco.MjModel, anatomy: Anatomy) -> Iterator[float]:
    masses = {model.body(body).name: float(model.body_mass[body]) for body in range(model.nbody)}
    for side, part in anatomy.mimos_parts:
        name, mass_kg = part.name.format(side=side), sum(geom.mass_kg for geom in part.geoms)
        if name in masses and mass_kg and part.region == "limb":
            yield masses[name] / mass_kg
