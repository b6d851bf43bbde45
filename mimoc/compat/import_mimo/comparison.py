"""The infant of a MIMo scene beside that of its spec: names that one of them lacks, and values that differ."""

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import Problem
from mimoc.compat.import_mimo.growth import Age
from mimoc.compat.import_mimo.infant import CHEST, HIP, UPPER_BODY, Infant
from mimoc.compat.import_mimo.references import Names, names_in_model

Array = npt.NDArray[np.float64]
Values = Mapping[str, Array]
SHOWN = 4
EYES = ("eye_left", "eye_right")
MM_PER_M = 1000.0
PERCENT = 100.0
NOTEWORTHY = 0.01
"""Relative difference from which values are said to differ."""
NOTEWORTHY_M = 2e-4
NOTEWORTHY_RAD = 0.01


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


def _age_text(age: Age) -> str:
    if not age.differences_m:
        return f"none of its geoms is MIMo's, so its age is unknown; the spec says {age.months:g} months"
    law = f"the sizes of {age.months:g} months by the published law of growth"
    if not age.differing:
        return f"it has {law}"
    most, count = age.differing[0], f"{len(age.differing)} of {len(age.differences_m)} geoms"
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
        change, reference = np.abs(scene[name] - mimocs[name]), np.abs(scene[name])
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
    more = f" and {len(names) - SHOWN} more" if len(names) > SHOWN else ""
    return ", ".join(names[:SHOWN]) + more
