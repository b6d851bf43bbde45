"""How old the infant of a MIMo scene is: the age at which the published law of growth gives it its sizes."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cache

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.anatomy.anatomy import Anatomy
from mimoc.base.geometry.solvers import narrowed
from mimoc.body.grow import grow_average
from mimoc.body.tree import BodyTree, Geom
from mimoc.compat.settings import MIMO_AGE_MONTHS
from mimoc.fits.curves import LAST_MONTH

PREFIX = "geom:"
"""Of the names of geoms in MIMo's later scenes."""
TOLERANCE_M = 2e-5
"""Difference of sizes up to which they are those of an age: files of MIMo's have four to eleven digits."""
OWN_MASSES = 0.02
"""Relative difference of masses, at the median, up to which a MIMo is the one that has not been grown."""
PRECISION_MONTHS = 1e-5
ROUNDING_M = 1e-6
"""Mean difference of sizes by which a round age may fit less well than any other."""
ROUND_TO = (1.0, 0.5, 0.1, 0.01, 0.001, 0.0001)
"""Ages that people write; the first of these that fits is taken."""

Sizes = Mapping[str, npt.NDArray[np.float64]]


@dataclass(frozen=True, slots=True)
class Age:
    """The age of a body, and how well it has the sizes of that age."""

    months: float
    differences_m: Mapping[str, float]
    """Largest difference of each geom's sizes from those of that age."""
    is_ungrown: bool = False
    """Whether it is MIMo's own model, which was made for 18 months and not grown."""

    @property
    def differing(self) -> list[str]:
        """The geoms that have not the sizes of that age, the one that differs most first."""
        names = [name for name, difference_m in self.differences_m.items() if difference_m > TOLERANCE_M]
        return sorted(names, key=lambda name: (-self.differences_m[name], name))

    @property
    def fits(self) -> bool:
        """Whether most geoms have the sizes of that age."""
        return 2 * len(self.differing) < len(self.differences_m)


def recognise_age(model: mujoco.MjModel, anatomy: Anatomy) -> Age:
    """Return the age of MIMo in a compiled scene.

    It is the age from whose sizes those of the scene's geoms differ least, as the sum over all that both have, which
    single geoms that somebody changed hardly move; MIMo's own model, which is recognised by its masses, is 18 months
    old.
    """

    @cache
    def grown(months: float) -> BodyTree:
        return grow_average(months, anatomy)

    sizes = geom_sizes(model, grown(MIMO_AGE_MONTHS))

    def errors(months: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        sums = [sum(_differences(sizes, grown(float(age))).values()) for age in months.flat]
        return np.array(sums).reshape(months.shape)

    if not sizes:
        return Age(MIMO_AGE_MONTHS, {})
    (low,), (high,) = narrowed(errors, np.array([0.0]), np.array([LAST_MONTH]), PRECISION_MONTHS)
    best = float(low + high) / 2
    least_m = float(np.sum(errors(np.array([best])))) + ROUNDING_M * len(sizes)
    rounded = [round(round(best / unit) * unit, 4) for unit in ROUND_TO]
    months = next((age for age in rounded if np.sum(errors(np.array([age]))) <= least_m), rounded[-1])
    age = Age(_as_written(months), _differences(sizes, grown(months)))
    if age.fits:
        return age
    ratios = list(_mass_ratios(model, anatomy))
    if ratios and abs(float(np.median(ratios)) - 1) < OWN_MASSES:
        return Age(MIMO_AGE_MONTHS, _differences(sizes, grown(MIMO_AGE_MONTHS)), is_ungrown=True)
    return Age(_as_written(rounded[2]), _differences(sizes, grown(rounded[2])))


def _as_written(months: float) -> float:
    return int(months) if months == int(months) else months


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


def _differences(sizes: Sizes, tree: BodyTree) -> dict[str, float]:
    wanted = {name: tree.geoms[name].size_m for name in sizes}
    return {name: float(np.max(np.abs(size[: len(wanted[name])] - wanted[name]))) for name, size in sizes.items()}


def _mass_ratios(model: mujoco.MjModel, anatomy: Anatomy) -> Iterator[float]:
    masses = {model.body(body).name: float(model.body_mass[body]) for body in range(model.nbody)}
    for side, part in anatomy.mimos_parts:
        name, mass_kg = part.name.format(side=side), sum(geom.mass_kg for geom in part.geoms)
        if name in masses and mass_kg and part.region == "limb":
            yield masses[name] / mass_kg
