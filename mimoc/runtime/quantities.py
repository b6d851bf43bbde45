"""Measuring: values of registered quantities, gathered while an infant acts, and reduced to one of a run."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.errors import KindError
from mimoc.base.kinds import function_of
from mimoc.base.quantities import measured_in
from mimoc.base.quantity import Quantity
from mimoc.bundle.manifest import Manifest
from mimoc.runtime.infant import Infant
from mimoc.runtime.term import Term, stack_terms
from mimoc.runtime.worlds import Worlds, worlds_of_one

Value = bool | int | float | None

REDUCERS: Mapping[str, Callable[[Sequence[Any]], Value]] = {
    "mean": lambda values: float(np.mean(values)) if values else None,
    "min": lambda values: float(min(values)) if values else None,
    "max": lambda values: float(max(values)) if values else None,
    "path": lambda points: float(np.linalg.norm(np.diff(points, axis=0), axis=1).sum()),
    "all": lambda values: all(map(bool, values)),
    "any": lambda values: any(map(bool, values)),
    "count": len,
}
"""From the values that there are to one of a run; of no values, means and extremes are None."""


@dataclass(frozen=True, slots=True)
class EpisodeResult:
    """The result of one episode of one infant; fields of quantities over episodes are its attributes."""

    total_reward: float  # The return: the sum of all rewards.
    steps: int  # Control steps.
    success: bool
    duration_s: float  # Duration in simulated time; the time to success if the episode was successful.
    seed: int | None = None  # Seed of its reset, where it is known.
    path_m: npt.NDArray[np.float64] | None = None
    """Positions of a tracked body at the start and after each control step, shape (steps + 1, 3), world frame."""

    @property
    def time_to_success_s(self) -> float | None:
        """Simulated time to success; None if the episode was not successful."""
        return self.duration_s if self.success else None


def measure(over: str, step: str, things: Sequence[object]) -> dict[str, Value]:
    """Return the quantities that a step of a cohort measures over children, poses or episodes, by name.

    Each of the *things* has a value as an attribute; a KindError says which has none.
    """
    measured = [quantity for quantity in measured_in(step) if quantity.over == over]
    return {quantity.name: reduced(quantity, [_field(quantity, item) for item in things]) for quantity in measured}


class StepMeasures:
    """Values of the quantities over control steps of one infant, which may grow meanwhile."""

    def __init__(self, env: Infant, step: str):
        """Bind the quantities of a step; raise a KindError if one does not measure a number."""
        self._env, self._data = env, env.data
        self._quantities = [
            quantity
            for quantity in measured_in(step)
            if quantity.over == "step" and not (step == "record" and quantity.reduce == "path")
        ]
        self._readers = self._bind()
        self._values: dict[str, list[Any]] = {quantity.name: [] for quantity in self._quantities}

    def read(self, info: Mapping[str, Any]) -> dict[str, Any]:
        """Return the values of this moment by name, given the `info` of the control step."""
        if self._env.data is not self._data:
            self._data, self._readers = self._env.data, self._bind()
        readers = self._readers
        return {
            item.name: readers[item.name]() if item.name in readers else info.get(item.key) for item in self._quantities
        }

    def add(self, info: Mapping[str, Any]) -> None:
        """Keep the values of this moment."""
        for name, value in self.read(info).items():
            self._values[name].append(value)

    def measures(self) -> dict[str, Value]:
        """Return what was kept, reduced to one value each, by name."""
        return {quantity.name: reduced(quantity, self._values[quantity.name]) for quantity in self._quantities}

    def _bind(self) -> dict[str, Callable[[], Any]]:
        env, worlds = self._env, worlds_of_one(self._env.data)
        readers: dict[str, Callable[[], Any]] = {}
        for quantity in self._quantities:
            if quantity.term is not None:
                term = stack_terms([function_of(quantity.term, quantity.name)(env.model, env.manifest)])
                readers[quantity.name] = lambda term=term: term(worlds)[0].copy()
            elif quantity.read is not None:
                readers[quantity.name] = function_of(quantity.read, quantity.name)(env)
            shape = np.shape(readers[quantity.name]()) if quantity.name in readers else ()
            if shape and quantity.reduce != "path":
                what = f"'{quantity.name}' measures an array of shape {shape} of an infant"
                raise KindError(f"{what}; return a number, or reduce points by 'path'")
        return readers


def _field(quantity: Quantity, item: object) -> Any:
    try:
        return getattr(item, quantity.key)
    except AttributeError:
        has = f"{type(item).__name__}, which has no '{quantity.key}'"
        raise KindError(f"the quantity '{quantity.name}' is over {quantity.over}: {has}; name a field of it") from None


def reduced(quantity: Quantity, values: Sequence[Any]) -> Value:
    """Return what a quantity makes of the values that there are, without None."""
    return REDUCERS[quantity.reduce]([value for value in values if value is not None])


@dataclass(frozen=True)
class JointSpeed(Term):
    """Mean absolute velocity of the hinges, mean over j of |qvel_j|, shape (k,), [rad/s]."""

    dofs: np.ndarray  # Degree of freedom of each hinge, shape (hinges,).

    def __call__(self, worlds: Worlds, *args: Any) -> Any:
        """Return it for k infants."""
        xp = worlds.xp
        return xp.mean(xp.abs(xp.take(worlds.qvel, self.dofs, axis=1)), axis=1)


@dataclass(frozen=True)
class BodyPosition(Term):
    """Position of the frame of a body in the world, shape (k, 3), [m]."""

    body: int

    def __call__(self, worlds: Worlds, *args: Any) -> Any:
        """Return it for k infants."""
        return worlds.xpos[:, self.body, :]


@dataclass(frozen=True)
class BodyHeight(Term):
    """Height of the centre of mass of a body above z = 0, shape (k,), [m]."""

    body: int

    def __call__(self, worlds: Worlds, *args: Any) -> Any:
        """Return it for k infants."""
        return worlds.xipos[:, self.body, 2]


def joint_speed_rad_s(model: mujoco.MjModel, manifest: Manifest) -> Term:
    """Return the term of the speed of all hinges of the infant."""
    is_of_infant = model.body_rootid[model.jnt_bodyid] == model.body(manifest.root_body).id
    return JointSpeed(model.jnt_dofadr[is_of_infant & (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE)])


def hip_path_m(model: mujoco.MjModel, manifest: Manifest) -> Term:
    """Return the term of the place of the infant's root body, the hip."""
    return BodyPosition(model.body(manifest.root_body).id)


def head_height_m(model: mujoco.MjModel, manifest: Manifest) -> Term:
    """Return the term of the height of the head, or of the root body of an infant without one."""
    return BodyHeight(model.body(manifest.anatomy.head or manifest.root_body).id)


head_lowest_m = head_height_m


def contacts_self(env: Infant) -> Callable[[], float]:
    """Return a function that counts the contacts of this moment between parts of the infant's own body."""

    def count() -> float:
        model = env.model
        is_own = model.body_rootid[model.geom_bodyid] == model.body(env.manifest.root_body).rootid
        pairs = env.data.contact.geom.reshape(-1, 2)
        return int(np.count_nonzero((pairs >= 0).all(axis=1) & is_own[pairs].all(axis=1)))

    return count
