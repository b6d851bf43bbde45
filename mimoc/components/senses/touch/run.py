"""Touch: the contact forces on the skin, also of the infant touching itself; of one infant, or of many at once."""

from collections import defaultdict
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
from gymnasium.spaces import Box

from mimoc.base.errors import BundleError, RenderingError
from mimoc.bundle.io import Bundle
from mimoc.components.senses.touch import POINTS, Channel, TouchEntry
from mimoc.components.senses.touch.adaptation import Stroking, adapting
from mimoc.components.senses.touch.receptors import (
    FIELDS,
    ContactForces,
    Receptors,
    bind_receptors,
    contact_forces,
    rotated,
    skin_body_of_geoms,
)
from mimoc.render.body_camera import Markers, force_markers
from mimoc.runtime.noise import Draw, Noise
from mimoc.runtime.sense import FloatArray, IntArray, Observation, Sample, Sense, SkinState
from mimoc.runtime.worlds import Worlds

MAX_FORCE_N = 1e4  # Bound of the observation; an infant weighs a hundred.
COLUMNS = np.arange(3)[:, None, None]  # Places of the numbers of a point after its first one.

Response = Callable[[Receptors, IntArray, FloatArray, FloatArray], tuple[IntArray, FloatArray]]
"""Which receptors respond to a contact, and how much each; see `Receptors.share`."""


@dataclass(frozen=True, slots=True)
class Measure:
    """What a receptor measures of a contact: numbers, and how these are read."""

    numbers: tuple[str, ...]  # What its numbers are.
    low_n: float  # Their least value.
    read: Callable[[ContactForces, FloatArray], FloatArray]
    """Returns it for m contacts with bodies of orientations (m, 3, 3), shape (m, numbers)."""


class Touch(Sense):
    """What the receptors of the skin measure: one after another, all numbers of each, [N]."""

    def __init__(
        self,
        receptors: Receptors,
        model: mujoco.MjModel,
        quantity: Measure,
        response: Response,
        channels: tuple[Channel, ...] = (),
        stroked: Stroking | None = None,
    ):
        """Measure a quantity of the contacts with the bodies that have receptors, or *channels* of its pressure.

        What strokes them is measured by *stroked*, if any channel is of that.
        """
        self.receptors, self.quantity, self.response = receptors, quantity, response
        self.body_of_geom = skin_body_of_geoms(receptors.bodies, model)
        self.channels, self.stroked = channels, stroked
        self.width = len(quantity.numbers)
        """How many numbers of each point are measured."""
        self.bodies = np.tile(receptors.bodies, len(channels)) if channels else np.repeat(receptors.bodies, self.width)
        self.filter = adapting(channels, self.width) if channels else None
        self.spaces = {"touch": Box(quantity.low_n, MAX_FORCE_N, self.bodies.shape, np.float32)}

    @property
    def layout(self) -> tuple[str, ...]:
        """What each number is: a body, which of its points, and what that measures."""
        indices: defaultdict[str, count[int]] = defaultdict(count)
        points = [f"{body} {next(indices[body])}" for body in self.receptors.names.tolist()]
        if self.channels:
            return tuple(f"{point} {channel} [{UNITS[channel]}]" for channel in self.channels for point in points)
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

    def _measure(self, data: mujoco.MjData, quantity: Measure) -> FloatArray:
        size = len(self.receptors.bodies) * len(quantity.numbers)
        forces = contact_forces(data.contact, data.efc_force, self.body_of_geom)
        if forces is None:
            return np.zeros(size)
        places_m, loads = _loads(forces, data.xpos, data.xmat, quantity)
        if self.stroked and quantity is STROKED:
            loads = self.stroked(data, forces, loads)
        receptors, shares = self.response(self.receptors, forces.bodies, places_m, loads)
        return _sums(receptors * len(quantity.numbers) + COLUMNS[: len(quantity.numbers)], shares, size)[:size]


class TouchReader:
    """Reads the touch of k infants whose models have as many bodies and geoms as each other's.

    It is one array expression over the contacts of all of them. Infants of one bundle share their receptors, and the
    forces on them are shared out together.
    """

    def __init__(self, touches: Sequence[Touch]):
        self._touch = first = touches[0]
        self._bodies = len(first.receptors.scale_per_m)
        self._geoms = len(first.body_of_geom)
        self._size = len(first.receptors.bodies) * first.width
        table = np.stack([touch.body_of_geom for touch in touches])
        self._body_of_geom = np.where(table, table + np.arange(len(touches))[:, None] * self._bodies, 0).ravel()
        self._receptors = list({id(touch.receptors): touch.receptors for touch in touches}.values())
        kinds = {id(receptors): kind for kind, receptors in enumerate(self._receptors)}
        self._kinds = np.array([kinds[id(touch.receptors)] for touch in touches])

    def __call__(self, worlds: Worlds) -> Sequence[Sample]:
        """Return a sample of each."""
        counts, contacts, efc_force = _joined(worlds.datas, self._geoms)
        forces = contact_forces(contacts, efc_force, self._body_of_geom)
        if forces is None:
            return [np.zeros(self._size) for _ in counts]
        samples: dict[int, Sample] = {}
        owners = np.repeat(np.arange(len(counts)), counts).take(forces.contacts)
        xpos, xmat = worlds.xpos.reshape(-1, 3), worlds.xmat.reshape(-1, 9)
        places_m, loads = _loads(forces, xpos, xmat, self._touch.quantity)
        bodies = forces.bodies - owners * self._bodies
        for kind, receptors in enumerate(self._receptors):
            members = np.flatnonzero(self._kinds == kind)
            which = np.flatnonzero(self._kinds[owners] == kind)
            if which.size:
                rows = np.searchsorted(members, owners[which])
                shared = self._touch.response(receptors, bodies[which], places_m[which], loads[which])
                samples |= zip(members.tolist(), self._felt(*shared, rows, len(members)), strict=True)
        return [samples[index] if index in samples else np.zeros(self._size) for index in range(len(counts))]

    def _felt(self, receptors: IntArray, shares: FloatArray, rows: IntArray, count: int) -> FloatArray:
        """Return what some infants measure, shape (count, size), of loads on the infants in *rows*.

        Beyond the numbers of each there is room for the receptor that pads tables.
        """
        row = self._size + self._touch.width
        numbers = (receptors * self._touch.width + rows[:, None] * row) + COLUMNS[: self._touch.width]
        return _sums(numbers, shares, count * row).reshape(count, row)[:, : self._size]


def bind(entry: TouchEntry, model: mujoco.MjModel, bundle: Bundle) -> Touch:
    """Put the skin of *entry* on the bodies of *model*.

    Raises:
        BundleError: If the bundle does not have the points that the entry tells of.
    """
    points_m = bundle.arrays.get(POINTS)
    if points_m is None or points_m.shape != (sum(part.points for part in entry.skin), 3):
        raise BundleError(f"the skin points of '{bundle.manifest.name}' are damaged; build the bundle again")
    receptors = bind_receptors(entry.skin, points_m, model)
    if bundle.manifest.prefix:
        names = [bundle.manifest.of_infant(name) for name in receptors.names.tolist()]
        receptors = replace(receptors, names=np.array(names))
    quantity, stroked = QUANTITIES[entry.quantity], None
    if "ct" in entry.channels:
        quantity = STROKED
        stroked = Stroking(model, frozenset(model.body(name).id for name in entry.hairless))
    return Touch(receptors, model, quantity, RESPONSES[entry.response], entry.channels, stroked)


def join(senses: Sequence[Sense]) -> TouchReader | None:
    """Return what reads many infants, or None if their worlds differ in more than numbers."""
    touches = [sense for sense in senses if isinstance(sense, Touch)]
    sizes = {(len(touch.receptors.scale_per_m), len(touch.body_of_geom)) for touch in touches}
    if len(touches) < len(senses) or len(sizes) > 1 or any(touch.stroked for touch in touches):
        return None
    return TouchReader(touches)


def skin_markers(bundle: Bundle, model: mujoco.MjModel, data: mujoco.MjData) -> Markers:
    """Return a marker for each point of an infant's skin, in the colour of the force on it.

    Raises:
        RenderingError: If the infant has no sense of touch.
    """
    entry: TouchEntry | None = bundle.manifest.senses.touch
    if entry is None:
        raise RenderingError(
            f"'{bundle.manifest.name}' has no sense of touch, so no skin to show; "
            "add `senses: {touch: {}}` to its spec, and build it again"
        )
    state = bind(entry, model, bundle).skin_state(data)
    spacings_m = {bundle.manifest.of_infant(part.body): part.spacing_m for part in entry.skin}
    sizes_n = np.linalg.norm(state.forces, axis=1)
    return force_markers(state.positions, sizes_n, np.array([spacings_m[body] for body in state.bodies]))


def _loads(
    forces: ContactForces, xpos: FloatArray, xmat: FloatArray, quantity: Measure
) -> tuple[FloatArray, FloatArray]:
    """Return where forces are, in the frames of their bodies, shape (m, 3), and what is measured of them."""
    world_from_body = xmat.take(forces.bodies, 0).reshape(-1, 3, 3)
    places_m = rotated(forces.places_m - xpos.take(forces.bodies, 0), world_from_body)
    return places_m, quantity.read(forces, world_from_body)


def _sums(numbers: IntArray, shares: FloatArray, size: int) -> FloatArray:
    return np.bincount(numbers.ravel(), shares.ravel(), size)  # pyright: ignore[reportReturnType] - Sums.


def _joined(datas: Sequence[mujoco.MjData], geoms: int) -> tuple[list[int], SimpleNamespace, FloatArray]:
    """Return how many contacts each of k infants has, all of them, and all forces of constraints.

    Their geoms are those of the infant before and its own after each other, and so are their addresses of forces.
    """
    contacts, forces = [data.contact for data in datas], [data.efc_force for data in datas]
    joined = SimpleNamespace(
        **{name: np.concatenate([getattr(contact, name) for contact in contacts]) for name in FIELDS}
    )
    counts = [len(contact) for contact in contacts]
    starts = np.cumsum([0, *map(len, forces[:-1])])
    joined.geom = joined.geom + np.repeat(np.arange(len(datas)) * geoms, counts)[:, None]
    addresses = joined.efc_address + np.repeat(starts, counts)
    joined.efc_address = np.where(joined.efc_address < 0, -1, addresses)
    return counts, joined, np.concatenate(forces)


QUANTITIES: Mapping[str, Measure] = {
    "force_vector": Measure(("x", "y", "z"), -MAX_FORCE_N, lambda forces, axes: rotated(forces.forces_n, axes)),
    "force_vector_global": Measure(
        ("world x", "world y", "world z"), -MAX_FORCE_N, lambda forces, axes: forces.forces_n
    ),
    "normal": Measure(("pressure",), 0.0, lambda forces, axes: forces.normal_forces_n),
}
STROKED = Measure(("pressure", "stroked"), 0.0, lambda forces, axes: forces.normal_forces_n.repeat(2, axis=1))
"""The pressure, and what of it is stroking."""
UNITS: Mapping[str, str] = {"sa1": "N", "ra": "N", "pc": "N", "ct": "1"}  # Unit of each channel.

RESPONSES: Mapping[str, Response] = {"linear": Receptors.share, "nearest": Receptors.nearest}


@dataclass(frozen=True)
class TouchNoise(Noise):
    """Adds noise to the size of each force, which is never less than zero; where nothing touches, nothing is felt.

    The noise of each sample is independent of the one before.
    """

    deviation_n: FloatArray  # Standard deviation of the size of a force, shape (1,).
    width: int  # How many numbers of a sample make a force.

    def __call__(self, draw: Draw, sample: Any, state: Any) -> tuple[Any, Any]:
        """Return a sample with noise, shape (k, size), and no state."""
        xp = draw.xp
        forces = xp.reshape(sample, (sample.shape[0], -1, self.width))
        sizes_n = xp.sqrt(xp.sum(forces * forces, axis=-1))
        felt = sizes_n > 0
        noisy_n = xp.maximum(sizes_n + self.deviation_n * draw.normals(sizes_n.shape, felt), 0.0)
        factors = noisy_n / xp.where(felt, sizes_n, 1.0)
        return xp.reshape(forces * factors[..., None], sample.shape), None


def bind_noise(amount_n: float, sense: Touch, low_pass_s: float) -> TouchNoise:
    """Return the noise of a sense of touch."""
    return TouchNoise(np.array([amount_n]), 1 if sense.channels else sense.width)
