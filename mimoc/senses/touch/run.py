"""Touch: what the skin feels of all that it meets, the infant's own body too."""

from collections import defaultdict
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import count

import mujoco
import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box

from mimoc.bundle.io import Bundle
from mimoc.senses.sense import FloatArray, IntArray, Observation, Reading
from mimoc.senses.touch.contacts import Pushes, feeling_bodies, find_pushes, rotated
from mimoc.senses.touch.receptors import Skin, bind_skin
from mimoc.senses.touch.spec import TouchEntry

MAX_FORCE_N = 1e4
"""Bound of the observation; an infant weighs a hundred."""

Spread = Callable[[Skin, IntArray, FloatArray, FloatArray], tuple[IntArray, FloatArray]]
"""From the skin, what is touched, where, and what there is to feel, to the points that feel it, and what each feels."""


@dataclass(frozen=True, slots=True)
class SkinState:
    """Where the n points of a skin are, and what acts on them."""

    bodies: npt.NDArray[np.str_]
    """The name of each point's body, shape (n,)."""
    positions: FloatArray
    """Shape (n, 3), in the world, [m]."""
    forces: FloatArray
    """Shape (n, 3), in the world, [N]."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """What a point feels of a push."""

    numbers: tuple[str, ...]
    """What its numbers are."""
    columns: IntArray
    """Where they are after the first one, shape (numbers, 1, 1)."""
    low_n: float
    """The least that one can be."""
    read: Callable[[Pushes, FloatArray], FloatArray]
    """Returns it for m pushes on bodies of orientations (m, 3, 3), shape (m, numbers)."""


@dataclass(frozen=True)
class Touch:
    """What the points of a skin feel: point after point, all numbers of each, [N]."""

    skin: Skin
    feeling: IntArray
    """The body of each geom, or 0 if it has no skin, shape (ngeom + 1,)."""
    quantity: Quantity
    spread: Spread
    """Who feels it."""

    @property
    def spaces(self) -> Mapping[str, Box]:
        """The space of the vector."""
        shape = (len(self.skin.names) * len(self.quantity.numbers),)
        return {"touch": Box(self.quantity.low_n, MAX_FORCE_N, shape, np.float32)}

    @property
    def layout(self) -> tuple[str, ...]:
        """What each number is: a body, which of its points, and what that feels."""
        indices: defaultdict[str, count[int]] = defaultdict(count)
        points = [f"{body} {next(indices[body])}" for body in self.skin.names.tolist()]
        return tuple(f"{point} {number} [N]" for point in points for number in self.quantity.numbers)

    @property
    def bodies(self) -> IntArray:
        """The body in which each number is felt."""
        return np.repeat(self.skin.bodies, len(self.quantity.numbers))

    def __call__(self, data: mujoco.MjData) -> FloatArray:
        """Return what is felt now."""
        return self._feel(data, self.quantity)

    def skin_state(self, data: mujoco.MjData) -> SkinState:
        """Return where the points are now, and what forces act on them, whatever the agent feels of these."""
        world_from_body = data.xmat[self.skin.bodies].reshape(-1, 3, 3)
        positions = data.xpos[self.skin.bodies] + (world_from_body @ self.skin.points_m[:, :, None])[:, :, 0]
        forces = self._feel(data, QUANTITIES["force_vector_global"]).reshape(-1, 3)
        return SkinState(self.skin.names, positions, forces)

    def observe(self, reading: Reading) -> Observation:
        """Return the reading within its bounds."""
        observed = reading.astype(np.float32)
        if np.maximum.reduce(observed) > MAX_FORCE_N or np.minimum.reduce(observed) < self.quantity.low_n:
            np.clip(observed, self.quantity.low_n, MAX_FORCE_N, out=observed)
        return {"touch": observed}

    def follow(self, model: mujoco.MjModel) -> bool:
        """Return False: other scenes have other geoms."""
        return False

    def close(self) -> None:
        """Do nothing: numbers hold nothing."""

    def _feel(self, data: mujoco.MjData, quantity: Quantity) -> FloatArray:
        width = len(quantity.numbers)
        size = len(self.skin.names) * width
        pushes = find_pushes(data, self.feeling)
        if pushes is None:
            return np.zeros(size)
        world_from_body = data.xmat.take(pushes.bodies, 0).reshape(-1, 3, 3)
        places_m = rotated(pushes.places_m - data.xpos.take(pushes.bodies, 0), world_from_body)
        felt = quantity.read(pushes, world_from_body)
        points, shares = self.spread(self.skin, pushes.bodies, places_m, felt)
        numbers = points * width + quantity.columns
        return np.bincount(numbers.ravel(), shares.ravel(), size)[:size]  # pyright: ignore[reportReturnType] - Sums.


def bind(entry: TouchEntry, model: mujoco.MjModel, bundle: Bundle) -> Touch:
    """Put the skin of *entry* on the bodies of *model*."""
    skin = bind_skin(entry.points_m, entry.spacing_m, model)
    return Touch(skin, feeling_bodies(skin.bodies, model), QUANTITIES[entry.quantity], RESPONSES[entry.response])


def _forces_on_body(pushes: Pushes, world_from_body: FloatArray) -> FloatArray:
    return rotated(pushes.forces_n, world_from_body)


def _forces_in_world(pushes: Pushes, world_from_body: FloatArray) -> FloatArray:
    return pushes.forces_n


def _pressures(pushes: Pushes, world_from_body: FloatArray) -> FloatArray:
    return pushes.pressures_n


def _columns(width: int) -> IntArray:
    return np.arange(width).reshape(-1, 1, 1)


QUANTITIES: Mapping[str, Quantity] = {
    "force_vector": Quantity(("x", "y", "z"), _columns(3), -MAX_FORCE_N, _forces_on_body),
    "force_vector_global": Quantity(("world x", "world y", "world z"), _columns(3), -MAX_FORCE_N, _forces_in_world),
    "normal": Quantity(("pressure",), _columns(1), 0.0, _pressures),
}
"""What can be felt."""

RESPONSES: Mapping[str, Spread] = {"linear": Skin.around, "nearest": Skin.nearest}
"""Who feels it."""
