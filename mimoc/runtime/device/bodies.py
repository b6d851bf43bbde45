"""The bodies of many worlds: one model of MuJoCo Warp, with arrays of its own for each world where infants differ."""

import dataclasses
from collections.abc import Collection, Sequence
from typing import Any

import mujoco
import mujoco_warp as mjw
import numpy as np
import warp as wp

from mimoc.base.errors import MimocError
from mimoc.runtime.gymnasium_forms import first_of
from mimoc.runtime.sense import IntArray

TOLERANCE = 1e-8
"""Tolerance of the solver. With MuJoCo Warp's own, 1e-6, light joints such as those of the eyes drift from MuJoCo's by
1e-3 rad in 20 steps, with this one by less than 1e-6 (measured at seven ages; 1e-10 is no better in 32-bit numbers)."""

NOT_COMPARED = {"opt", "callback", "block_dim", "dof_length", "nkey"}
"""Fields that may differ: the first three are no numbers of a body, and `opt` is compared by itself; only sleeping uses
`dof_length`, and it is off; nothing uses `nkey`."""
KEYFRAMES = "key_"  # How the fields of keyframes begin; a table of starts has them instead.
SHAPES = {field.name: getattr(field.type, "shape", None) for field in dataclasses.fields(mjw.Model)}
BATCHED = {name for name, shape in SHAPES.items() if isinstance(shape, tuple) and shape[:1] == ("*",)}
"""Fields that can be another in each world."""
COUNTS = {
    "nbody": "bodies",
    "njnt": "joints",
    "ngeom": "geoms",
    "nmesh": "meshes",
    "nmat": "materials",
    "nlight": "lights",
    "neq": "locks and welds",
}
"""What an error names as the difference of models, rather than fields that follow from it."""


class WorldsError(MimocError):
    """Infants whose bodies cannot share one model of MuJoCo Warp."""


class WorldsModel:
    """The model of many worlds, on Warp's present device; what is written to it keeps its place in memory.

    What differs is found by comparing what MuJoCo Warp makes of each model, not from a list of fields. Where it first
    differs later, when infants have grown, a field moves to a larger place.
    """

    def __init__(self, models: Sequence[mujoco.MjModel], body_of_world: IntArray, changed: Collection[str] = ()):
        self._source = models[0]
        self._count = len(body_of_world)
        self._own = set(changed)
        self._first = _put(models[0])
        self.warp = _put(models[0], dict.fromkeys(sorted(changed), self._count))  # MuJoCo Warp's model.
        self.warp.opt.tolerance.fill_(TOLERANCE)
        self.warp.opt.warn_overflow = 0  # What overflows is reported by `capacity.report` instead of a printed line.
        self.write(self.fit(models)[0], np.arange(self._count), body_of_world)

    def fit(self, models: Sequence[mujoco.MjModel], changed: Collection[str] = ()) -> tuple[list[mjw.Model], bool]:
        """Make room for bodies that differ; return MuJoCo Warp's model of each, and whether a field has moved."""
        put = [_put(model) for model in models]
        new = own_fields([self._first, *put]).union(changed) - self._own
        if new:
            larger = _put(self._source, dict.fromkeys(sorted(new), self._count))
            for name in new:
                setattr(self.warp, name, getattr(larger, name))
            self._own |= new
        return put, bool(new)

    def write(self, put: Sequence[mjw.Model], worlds: IntArray, body_of_world: IntArray) -> None:
        """Write the bodies of some worlds, shape (worlds,), as they are built."""
        for name in sorted(self._own):
            values = np.concatenate([getattr(model, name).numpy() for model in put])
            array = getattr(self.warp, name)
            whole = array.numpy()
            whole[worlds] = values[body_of_world]
            array.assign(whole)


def batched_data(
    models: Sequence[mujoco.MjModel], body_of_world: IntArray, contacts: int, constraints: int
) -> mjw.Data:
    """Return the states of many worlds, with room for contacts and rows of constraints."""
    batched = mjw.make_data(models[0], nworld=len(body_of_world), nconmax=contacts, njmax=constraints)
    place_fixed(batched, models, np.arange(len(body_of_world)), body_of_world)
    return batched


def place_fixed(data: mjw.Data, models: Sequence[mujoco.MjModel], worlds: IntArray, body_of_world: IntArray) -> None:
    """Write the places of geoms in some worlds, shape (worlds,): MuJoCo Warp computes fixed ones once, of one body."""
    states = [mujoco.MjData(model) for model in models]
    for model, state in zip(models, states, strict=True):
        mujoco.mj_kinematics(model, state)
    for name in ("geom_xpos", "geom_xmat"):
        array = getattr(data, name)
        whole = array.numpy()
        values = np.stack([getattr(state, name) for state in states]).reshape(len(states), *whole.shape[1:])
        whole[worlds] = values[body_of_world]
        array.assign(whole)


def enlarged(data: mjw.Data, model: mujoco.MjModel, contacts: int, constraints: int) -> mjw.Data:
    """Return the same states with other room; see `batched_data`."""
    larger = mjw.make_data(model, nworld=data.nworld, nconmax=contacts, njmax=constraints)
    for name in _names(mjw.Data):
        former, latter = getattr(data, name), getattr(larger, name)
        if isinstance(former, wp.array) and former.shape == latter.shape:
            wp.copy(latter, former)
    return larger


def own_fields(models: Sequence[mjw.Model]) -> set[str]:
    """Return the fields in which models differ."""
    names = {name for name in _names(mjw.Model) if name not in NOT_COMPARED and not name.startswith(KEYFRAMES)}
    differing = _differing(models, names)
    uneven = {name for name in differing & BATCHED if len({getattr(model, name).shape for model in models}) > 1}
    options = _differing([model.opt for model in models], _names(mjw.Option))
    shared = [*sorted(differing - BATCHED), *(f"opt.{name}" for name in sorted(options)), *sorted(uneven)]
    if shared:
        counts = [_counted(models, name, what) for name, what in COUNTS.items() if name in differing]
        raise WorldsError(
            "these infants and what lies around them cannot live side by side on this device: their models differ in "
            f"{first_of(counts or shared)}, which all worlds share; make an environment of each kind"
        )
    return differing


def _counted(models: Sequence[mjw.Model], name: str, what: str) -> str:
    first, *others = [getattr(model, name) for model in models]
    return f"the number of {what} ({first}, {next(count for count in others if count != first)})"


def _put(model: mujoco.MjModel, sizes: dict[str, int] | None = None) -> mjw.Model:
    try:
        return mjw.put_model(model, sizes)
    except (NotImplementedError, ValueError) as error:
        raise WorldsError(f"MuJoCo Warp cannot simulate this infant's world: {error}") from None


def _names(kind: Any) -> list[str]:
    return [field.name for field in dataclasses.fields(kind)]


def _differing(records: Sequence[Any], names: Collection[str]) -> set[str]:
    first, *rest = records
    return {name for name in names if not all(_same(getattr(first, name), getattr(other, name)) for other in rest)}


def _same(ours: Any, theirs: Any) -> bool:
    if isinstance(ours, wp.array):
        return ours.shape == theirs.shape and np.array_equal(ours.numpy(), theirs.numpy())
    if isinstance(ours, (tuple, list)):
        return len(ours) == len(theirs) and all(map(_same, ours, theirs))
    if isinstance(ours, np.ndarray):
        return np.array_equal(ours, theirs)
    if dataclasses.is_dataclass(ours):
        return not _differing([ours, theirs], _names(ours))
    return bool(ours == theirs)
