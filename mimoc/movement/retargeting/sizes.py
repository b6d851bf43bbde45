"""Sizes of a child that a recording can tell of: what they move, and the spec of a child that has them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.compiler.building import build
from mimoc.compiler.measuring import compile_infant
from mimoc.motion.body_points import BodyPoint
from mimoc.motion.labels import SIDES
from mimoc.motion.point_recording import FloatArray
from mimoc.movement.retargeting.skeleton import Shape
from mimoc.schema.body import LENGTHS
from mimoc.schema.infant import InfantSpec

PointsOf = Callable[[mujoco.MjModel], list[BodyPoint]]  # What gives the points that a fit needs on a model.
STEP = 0.05  # Change of a factor by which derivatives are computed; origins are linear in factors.
MIN_FACTOR, MAX_FACTOR = 0.6, 1.7  # Factors on parts that are tried, within those that a spec can have.
OVERALL_SD = 0.045
"""Standard deviation of the logarithm of a child's length: 3.5 % by WHO's standards up to two years, and the difference
between these and the survey of the average child."""
LENGTH_SD = 0.01
"""The same of a length that a spec gives: recumbent length is measured to about .6 cm at three months (D: twice the
technical error of measurement of WHO's observers, .3 cm)."""


@dataclass(frozen=True, slots=True)
class Size:
    """A factor on some parts of the body, on both sides."""

    name: str
    parts: tuple[str, ...]  # Names of parts, `{side}` for both.
    keys: tuple[str, ...]  # Which of their factors: `length`, `girth` or both.
    sd: float
    """How far its logarithm is usually from the average child's (D: SD of the survey's segment lengths, less that of
    overall length, and what pose estimators take for the same joint)."""

    def names(self) -> list[str]:
        """Return the names of its parts."""
        return [part.format(side=side) for part in self.parts for side in (SIDES if "{side}" in part else SIDES[:1])]


SIZES = (
    *(Size(name, (f"{{side}}_{name}",), ("length",), 0.07) for name in ("upper_arm", "lower_arm")),
    Size("hand", ("{side}_hand",), ("length",), 0.1),
    *(Size(name, (f"{{side}}_{name}",), ("length",), 0.07) for name in ("upper_leg", "lower_leg")),
    Size("foot", ("{side}_foot",), ("length",), 0.1),
    Size("trunk", ("hip", "lower_body", "upper_body"), ("length",), 0.06),
    Size("shoulders", ("chest",), ("girth",), 0.08),
    Size("hips", ("hip",), ("girth",), 0.08),
    Size("head", ("head",), ("length", "girth"), 0.05),
)
"""Sizes that are fitted, besides the overall size of the child."""


@dataclass(frozen=True)
class Child:
    """A child that is compiled."""

    spec: InfantSpec
    bundle: Bundle
    model: mujoco.MjModel


def compile_child(spec: InfantSpec) -> Child:
    """Return the child of a spec, of the spec's size, or raise a SpecError."""
    bundle = build(spec)
    return Child(spec, bundle, load_model(bundle))


def starting_spec(spec: InfantSpec | None, age_months: float | None, name: str) -> InfantSpec:
    """Return the spec that a fit starts from: the average child's, on its back, or the given one of that age.

    One of the two must be given, or the age is refused by a SpecError.
    """
    if spec is not None:
        return spec if age_months in (None, spec.age_months) else spec.with_(age_months=age_months)
    assert age_months is not None
    senses: Any = {"proprioception": {}, "vestibular": {}}
    scene: Any = {"kind": "flat", "pose": "supine"}
    return InfantSpec(mimoc=1, name=name, age_months=age_months, senses=senses, scene=scene)


def gives_length(spec: InfantSpec) -> bool:
    """Return whether a spec says how long its child is."""
    individual = spec.body.individual
    return individual is not None and any(getattr(individual, key) is not None for key in LENGTHS)


def resized(spec: InfantSpec, factors: Mapping[str, float], length_cm: float | None = None) -> InfantSpec:
    """Return the spec of a child with parts longer or wider by factors; None leaves the length as it is."""
    parts: dict[str, dict[str, float]] = {}
    for size in SIZES:
        if (factor := factors.get(size.name, 1.0)) == 1.0:
            continue
        for name in (name for name in size.names() if name not in spec.body.remove):
            before = spec.body.parts.get(name)
            for key in size.keys:
                value = (getattr(before, key) if before else 1.0) * factor
                parts.setdefault(name, {})[key] = round(float(np.clip(value, MIN_FACTOR, MAX_FACTOR)), 4)
    individual = (
        {} if length_cm is None else {"individual": {"length_percentile": None, "length_cm": round(length_cm, 2)}}
    )
    return spec.with_(body={"parts": parts, **individual})


def shape_of(child: Child, points: PointsOf, sizes: Sequence[Size]) -> Shape:
    """Return the vectors of a body, and their derivatives by the logarithms of its overall size and of other sizes.

    The first derivative, by overall size, is the vector itself. The others come from children with one size changed:
    origins and anchors are linear in the factors of parts.
    """
    base = _vectors(child.model, points)
    columns = [base, base]
    for size in sizes:
        changed = _vectors(compile_infant(resized(child.spec, {size.name: 1 + STEP})), points)
        columns.append(tuple(_slope(new, old) for new, old in zip(changed, base, strict=True)))
    bodies, anchors, offsets = (np.stack(arrays, axis=-1) for arrays in zip(*columns, strict=True))
    return Shape(bodies, anchors, offsets)


def at_sizes(shape: Shape, logs: FloatArray) -> Shape:
    """Return the vectors v = e^o (v_0 + sum_i (e^l_i - 1) d_i) at logs o, l_1 ..., with their derivatives by these."""
    return Shape(*(_scaled(array, logs) for array in (shape.bodies_m, shape.anchors_m, shape.points_m)))


def lengths_of(model: mujoco.MjModel) -> dict[str, float]:
    """Return the lengths of a compiled child in [m], by size; those of the right side for limbs."""
    spans = {
        "upper_arm": ("right_lower_arm", 2),
        "lower_arm": ("right_hand", 2),
        "upper_leg": ("right_lower_leg", 2),
        "lower_leg": ("right_foot", 2),
        "foot": ("right_toes", 0),
        "hand": ("right_fingers", 2) if _has(model, "right_fingers") else ("right_mfknuckle", 2),
        "shoulders": ("right_upper_arm", 1),
        "hips": ("right_upper_leg", 1),
    }
    lengths = {name: abs(float(model.body(b).pos[axis])) for name, (b, axis) in spans.items() if _has(model, b)}
    for name in {"shoulders", "hips"} & lengths.keys():
        lengths[name] *= 2
    lengths["trunk"] = float(sum(model.body(body).pos[2] for body in ("lower_body", "upper_body", "head")))
    skull = model.geom("head")
    lengths["head"] = 2 * float(skull.size.max())
    return lengths


def matched(spec: InfantSpec, wanted: Mapping[str, float], length_cm: float | None, rounds: int = 3) -> Child:
    """Return the child whose compiled lengths [m] are the given ones, to .1 %, in so many rounds, or raise a SpecError.

    With a *length_cm* of the child, parts only say how it differs from a child of that length.
    """
    child = compile_child(resized(spec, {}, length_cm) if length_cm else spec)
    for _ in range(rounds):
        lengths = lengths_of(child.model)
        factors = {name: value / lengths[name] for name, value in wanted.items()}
        if all(abs(factor - 1) < 1e-3 for factor in factors.values()):
            break
        child = compile_child(resized(child.spec, factors))
    return child


def _vectors(model: mujoco.MjModel, points: PointsOf) -> tuple[FloatArray, ...]:
    return model.body_pos.copy(), model.jnt_pos.copy(), np.array([point.offset_m for point in points(model)])


def _slope(new: FloatArray, old: FloatArray) -> FloatArray:
    """Return the change of vectors by that of a factor; what comes after the infant in its scene does not change."""
    slope = np.zeros_like(old)
    slope[: len(new)] = (new - old[: len(new)]) / STEP
    return slope


def _scaled(array: FloatArray, logs: FloatArray) -> FloatArray:
    overall, factors = np.exp(logs[0]), np.exp(logs[1:])
    vector = overall * (array[..., 0] + array[..., 2:] @ (factors - 1))
    return np.concatenate([vector[..., None], vector[..., None], overall * array[..., 2:] * factors], axis=-1)


def _has(model: mujoco.MjModel, body: str) -> bool:
    return mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_BODY, body) >= 0
