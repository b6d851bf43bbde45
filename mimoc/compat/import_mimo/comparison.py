"""The infant of a MIMo scene beside that of its spec: names that one of them lacks, and values that differ."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.anatomy.anatomy import Anatomy
from mimoc.base.errors import Problem
from mimoc.base.geometry.solvers import narrowed
from mimoc.body.grow import grow_average
from mimoc.body.tree import BodyTree, Geom
from mimoc.compat.import_mimo.infant import CHEST, HIP, UPPER_BODY, Infant
from mimoc.compat.settings import MIMO_AGE_MONTHS
from mimoc.fits.curves import LAST_MONTH

Array = npt.NDArray[np.float64]
Names = dict[str, set[str]]
Values = Mapping[str, Array]
MAX_LISTED = 4
EYES = ("eye_left", "eye_right")
MM_PER_M = 1000.0
PERCENT = 100.0
NOTEWORTHY = 0.01  # Relative difference from which values are said to differ.
NOTEWORTHY_M = 2e-4
NOTEWORTHY_RAD = 0.01


@dataclass(frozen=True, slots=True)
class Age:
    """The age of a body, and how well it has the sizes of that age."""

    months: float
    differences_m: Mapping[str, float]  # Largest difference of each geom's sizes from those of that age.
    is_ungrown: bool = False  # Whether it is MIMo's own model, which was made for 18 months and not grown.

    @property
    def differing(self) -> list[str]:
        """The geoms that have not the sizes of that age, the one that differs most first."""
        names = [name for name, difference_m in self.differences_m.items() if difference_m > TOLERANCE_M]
        return sorted(names, key=lambda name: (-self.differences_m[name], name))

    @property
    def fits(self) -> bool:
        """Whether most geoms have the sizes of that age."""
        return 2 * len(self.differing) < len(self.differences_m)


def notes_on_infant(
    infant: Infant, age: Age, model: mujoco.MjModel, mimocs: mujoco.MjModel, names: Names
) -> Iterator[Problem]:
    """Yield notes on how the infant of a scene differs from that of its spec, which is compiled as *mimocs*."""
    yield infant.hip.problem(_age_text(age))
    of_scene = names_in_model(model)
    mimos = {"joint": set(infant.hinges), "actuator": set(infant.motors) & of_scene["actuator"]}
    sensors = {name for name in of_scene["sensor"] if name.startswith(("proprio:", "vestibular_"))}
    for kind, of_kind in {**mimos, "sensor": sensors}.items():
        if lacking := sorted(of_kind - names[kind]):
            yield infant.hip.problem(f"mimoc's infant has no {kind} {_listed(lacking)}")
    if more := [name for name in infant.motors if name not in mimos["actuator"]]:
        yield infant.hip.problem(f"the scene has no actuator {_listed(more)}; mimoc's infant has all of MIMo's")
    yield from (infant.hip.problem(text) for text in _differences(infant, model, mimocs) if text)


def names_in_model(model: mujoco.MjModel) -> Names:
    """Return the names in a compiled model, by kind."""
    counts = {
        "body": model.nbody,
        "joint": model.njnt,
        "geom": model.ngeom,
        "site": model.nsite,
        "camera": model.ncam,
        "tendon": model.ntendon,
        "actuator": model.nu,
        "sensor": model.nsensor,
        "material": model.nmat,
        "texture": model.ntex,
    }
    return {kind: {getattr(model, kind)(index).name for index in range(count)} for kind, count in counts.items()}


def _age_text(age: Age) -> str:
    if not age.differences_m:
        return f"none of its geoms is MIMo's, so its age is unknown; the spec says {age.months:g} months"
    law = f"the sizes of {age.months:g} months by the published law of growth"
    if not age.differing:
        return f"it has {law}"
    most = age.differing[0]
    count = f"{len(age.differing)} of {len(age.differences_m)} geoms"
    largest = f"largest difference {MM_PER_M * age.differences_m[most]:.1f} mm, in {most}"
    if age.fits:
        return f"it has {law}, but for {count}: {largest}"
    if age.is_ungrown:
        return f"it is MIMo's own model, which was not grown; the spec's has {law}, and {count} differ: {largest}"
    return f"its sizes are those of no age by the published law of growth; nearest is {age.months:g} months: {largest}"


def _differences(infant: Infant, *models: mujoco.MjModel) -> Iterator[str]:
    """Yield what is said of masses, places, ranges, springs and strength in which two compiled infants differ."""
    masses = [_masses(model, infant) for model in models]
    total = f" ({_sum(masses[0]):.2f} kg in the scene, {_sum(masses[1]):.2f} in the spec)"
    yield _compared("masses of bodies", masses, relative=True, more=total)
    yield _compared("places of bodies", [_places(model, infant) for model in models], NOTEWORTHY_M, (MM_PER_M, " mm"))
    ranges = [_values(model, "joint", "range", infant.hinges) for model in models]
    yield _compared("ranges of joints", ranges, NOTEWORTHY_RAD, (math.degrees(1), " degrees"))
    for what in ("stiffness", "damping"):
        passive = [_values(model, "joint", what, infant.hinges) for model in models]
        yield _compared(f"{what} of joints", passive, relative=True)
    if not any(np.any(model.actuator_biastype) for model in models):
        gears = [_values(model, "actuator", "gear", infant.motors) for model in models]
        yield _compared("gears of motors", gears, relative=True)
    fields = [_values(model, "camera", "fovy", EYES) for model in models]
    yield _compared("fields of view", fields, NOTEWORTHY, (1.0, " degrees"))


def _values(model: mujoco.MjModel, kind: str, attribute: str, names: Iterable[str]) -> Values:
    count = {"body": model.nbody, "joint": model.njnt, "actuator": model.nu, "camera": model.ncam}[kind]
    view: Callable[[int], Any] = getattr(model, kind)
    wanted, elements = set(names), map(view, range(count))
    return {element.name: np.array(getattr(element, attribute)) for element in elements if element.name in wanted}


def _masses(model: mujoco.MjModel, infant: Infant) -> Values:
    """Return the masses of bodies; a chest without joints may be a body of its own or part of the upper body."""
    masses = {name: np.array(mass) for name, mass in _values(model, "body", "mass", set(infant.parents)).items()}
    if CHEST in masses and CHEST not in infant.bodies:
        masses[UPPER_BODY] = masses[UPPER_BODY] + masses.pop(CHEST)
    return masses


def _places(model: mujoco.MjModel, infant: Infant) -> Values:
    """Return where bodies are from the hip, with all joints at zero."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    hip = data.body(HIP)
    from_world = hip.xmat.reshape(3, 3).T
    bodies = (data.body(body) for body in range(model.nbody))
    return {body.name: from_world @ (body.xpos - hip.xpos) for body in bodies if body.name in infant.parents}


def _sum(values: Values) -> float:
    return float(np.sum(list(values.values())))


def _compared(
    what: str,
    of_both: Sequence[Values],
    noteworthy: float = NOTEWORTHY,
    unit: tuple[float, str] = (PERCENT, "%"),
    *,
    relative: bool = False,
    more: str = "",
) -> str:
    scene, mimocs = of_both
    sizes = dict[str, float]()
    for name in scene.keys() & mimocs.keys():
        change = np.abs(scene[name] - mimocs[name])
        reference = np.abs(scene[name])
        sizes[name] = float(np.max(change / np.where(reference > 0, reference, 1.0) if relative else change))
    differing = [name for name, size in sizes.items() if size > noteworthy]
    if not differing:
        return ""
    most = min(differing, key=lambda name: (-sizes[name], name))
    factor, word = unit
    return (
        f"{what} differ in {len(differing)} of {len(sizes)}, most in {most}, by {factor * sizes[most]:.4g}{word}{more}"
    )


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - MAX_LISTED} more" if len(names) > MAX_LISTED else ""
    return ", ".join(names[:MAX_LISTED]) + more


PREFIX = "geom:"  # Prefix of the names of geoms in MIMo's later scenes.
TOLERANCE_M = 2e-5
"""Difference of sizes up to which they are those of an age: files of MIMo's have four to eleven digits."""
OWN_MASSES = 0.02
"""Relative difference of masses, at the median, up to which a MIMo is the one that has not been grown."""
PRECISION_MONTHS = 1e-5
ROUNDING_M = 1e-6  # Mean difference of sizes by which a round age may fit less well than any other.
ROUND_TO = (1.0, 0.5, 0.1, 0.01, 0.001, 0.0001)  # Ages that people write; the first of these that fits is taken.

Sizes = Mapping[str, npt.NDArray[np.float64]]


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
        sums = [sum(_size_differences(sizes, grown(float(age))).values()) for age in months.flat]
        return np.array(sums).reshape(months.shape)

    if not sizes:
        return Age(MIMO_AGE_MONTHS, {})
    (low,), (high,) = narrowed(errors, np.array([0.0]), np.array([LAST_MONTH]), PRECISION_MONTHS)
    best = float(low + high) / 2
    least_m = float(np.sum(errors(np.array([best])))) + ROUNDING_M * len(sizes)
    rounded = [round(round(best / unit) * unit, 4) for unit in ROUND_TO]
    months = next((age for age in rounded if np.sum(errors(np.array([age]))) <= least_m), rounded[-1])
    age = Age(_as_written(months), _size_differences(sizes, grown(months)))
    if age.fits:
        return age
    ratios = list(_mass_ratios(model, anatomy))
    if ratios and abs(float(np.median(ratios)) - 1) < OWN_MASSES:
        return Age(MIMO_AGE_MONTHS, _size_differences(sizes, grown(MIMO_AGE_MONTHS)), is_ungrown=True)
    return Age(_as_written(rounded[2]), _size_differences(sizes, grown(rounded[2])))


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


def _size_differences(sizes: Sizes, tree: BodyTree) -> dict[str, float]:
    wanted = {name: tree.geoms[name].size_m for name in sizes}
    return {name: float(np.max(np.abs(size[: len(wanted[name])] - wanted[name]))) for name, size in sizes.items()}


def _mass_ratios(model: mujoco.MjModel, anatomy: Anatomy) -> Iterator[float]:
    masses = {model.body(body).name: float(model.body_mass[body]) for body in range(model.nbody)}
    for side, part in anatomy.mimos_parts:
        name = part.name.format(side=side)
        mass_kg = sum(geom.mass_kg for geom in part.geoms)
        if name in masses and mass_kg and part.region == "limb":
            yield masses[name] / mass_kg
