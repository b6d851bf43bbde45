"""Touch: the contact forces on the skin, also of the infant touching itself."""

from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import count

import mujoco
import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box

from mimoc.base.errors import BundleError
from mimoc.bundle.io import Bundle
from mimoc.senses.sense import FloatArray, IntArray, Observation, Sample, Sense
from mimoc.senses.touch.contacts import (
    ContactForces,
    contact_forces,
    rotated,
    skin_body_of_geoms,
)
from mimoc.senses.touch.receptors import Receptors, bind_receptors
from mimoc.senses.touch.spec import POINTS, TouchEntry

MAX_FORCE_N = 1e4
"""Bound of the observation; an infant weighs a hundred."""

Response = Callable[[Receptors, IntArray, FloatArray, FloatArray], tuple[IntArray, FloatArray]]
"""Which receptors respond to a contact, and how much each; see `Receptors.share`."""


@dataclass(frozen=True, slots=True)
class SkinState:
    """Where the n points of a skin are, and the forces on them."""

    bodies: npt.NDArray[np.str_]
    """The name of each point's body, shape (n,)."""
    positions: FloatArray
    """Shape (n, 3), in the world, [m]."""
    forces: FloatArray
    """Shape (n, 3), in the world, [N]."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """What a receptor measures of a contact."""

    numbers: tuple[str, ...]
    """What its numbers are."""
    columns: IntArray
    """Their places after the first one, shape (numbers, 1, 1)."""
    low_n: float
    """Their least value."""
    read: Callable[[ContactForces, FloatArray], FloatArray]
    """Returns it for m contacts with bodies of orientations (m, 3, 3), shape (m, numbers)."""


class Touch(Sense):
    """What the receptors of the skin measure: one after another, all numbers of each, [N]."""

    def __init__(self, receptors: Receptors, model: mujoco.MjModel, quantity: Quantity, response: Response):
        """Measure a quantity of the contacts with the bodies that have receptors."""
        self.receptors, self.quantity, self.response = receptors, quantity, response
        self.body_of_geom = skin_body_of_geoms(receptors.bodies, model)
        self.width = len(quantity.numbers)
        """How many numbers each point has."""
        self.bodies = np.repeat(receptors.bodies, self.width)
        shape = (len(receptors.bodies) * self.width,)
        self.spaces = {"touch": Box(quantity.low_n, MAX_FORCE_N, shape, np.float32)}

    @property
    def layout(self) -> tuple[str, ...]:
        """What each number is: a body, which of its points, and what that measures."""
        indices: defaultdict[str, count[int]] = defaultdict(count)
        points = [f"{body} {next(indices[body])}" for body in self.receptors.names.tolist()]
        return tuple(f"{point} {number} [N]" for point in points for number in self.quantity.numbers)

    def __call__(self, data: mujoco.MjData) -> Sample:
        """Return the sample now."""
        return self._measure(data, self.quantity)

    def skin_state(self, data: mujoco.MjData) -> SkinState:
        """Return where the points are now and the forces on them, whatever quantity the agent observes."""
        world_from_body = data.xmat[self.receptors.bodies].reshape(-1, 3, 3)
        rotated_m = (world_from_body @ self.receptors.points_m[:, :, None])[:, :, 0]
        forces = self._measure(data, QUANTITIES["force_vector_global"]).reshape(-1, 3)
        return SkinState(self.receptors.names, data.xpos[self.receptors.bodies] + rotated_m, forces)

    def observe(self, sample: Sample) -> Observation:
        """Return the sample within its bounds."""
        observation = {"touch": np.empty(sample.shape, np.float32)}
        self.write(sample, observation)
        return observation

    def write(self, sample: Sample, observation: Observation) -> None:
        """Write the sample within its bounds, which it seldom reaches."""
        observed, low_n = observation["touch"], self.quantity.low_n
        observed[:] = sample
        if np.maximum.reduce(observed) > MAX_FORCE_N or np.minimum.reduce(observed) < low_n:
            np.clip(observed, low_n, MAX_FORCE_N, out=observed)

    def _measure(self, data: mujoco.MjData, quantity: Quantity) -> FloatArray:
        width = len(quantity.numbers)
        size = len(self.receptors.bodies) * width
        forces = contact_forces(data, self.body_of_geom)
        if forces is None:
            return np.zeros(size)
        world_from_body = data.xmat.take(forces.bodies, 0).reshape(-1, 3, 3)
        places_m = rotated(forces.places_m - data.xpos.take(forces.bodies, 0), world_from_body)
        loads = quantity.read(forces, world_from_body)
        receptors, shares = self.response(self.receptors, forces.bodies, places_m, loads)
        numbers = receptors * width + quantity.columns
        return np.bincount(numbers.ravel(), shares.ravel(), size)[:size]  # pyright: ignore[reportReturnType] - Sums.


def bind(entry: TouchEntry, model: mujoco.MjModel, bundle: Bundle) -> Touch:
    """Put the skin of *entry* on the bodies of *model*.

    Raises:
        BundleError: If the bundle does not have the points that the entry tells of.
    """
    points_m = bundle.arrays.get(POINTS)
    if points_m is None or points_m.shape != (sum(part.points for part in entry.skin), 3):
        raise BundleError(f"the skin points of '{bundle.manifest.name}' are damaged; build the bundle again")
    receptors = bind_receptors(entry.skin, points_m, model)
    return Touch(receptors, model, QUANTITIES[entry.quantity], RESPONSES[entry.response])


def _forces_on_body(forces: ContactForces, world_from_body: FloatArray) -> FloatArray:
    return rotated(forces.forces_n, world_from_body)


def _forces_in_world(forces: ContactForces, world_from_body: FloatArray) -> FloatArray:
    return forces.forces_n


def _normal_forces(forces: ContactForces, world_from_body: FloatArray) -> FloatArray:
    return forces.normal_forces_n


def _columns(width: int) -> IntArray:
    return np.arange(width).reshape(-1, 1, 1)


QUANTITIES: Mapping[str, Quantity] = {
    "force_vector": Quantity(("x", "y", "z"), _columns(3), -MAX_FORCE_N, _forces_on_body),
    "force_vector_global": Quantity(("world x", "world y", "world z"), _columns(3), -MAX_FORCE_N, _forces_in_world),
    "normal": Quantity(("pressure",), _columns(1), 0.0, _normal_forces),
}
"""What can be measured."""

RESPONSES: Mapping[str, Response] = {"linear": Receptors.share, "nearest": Receptors.nearest}
"""Which receptors respond."""
