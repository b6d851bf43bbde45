"""What k infants feel of some of their hinges: angles and speeds, by proprioception, or else by the simulation."""

import operator
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from mimoc.policies.policy import Batch

SENSE = "proprioception"


@dataclass(frozen=True, slots=True)
class Turned:
    """The angles and speeds of c hinges of k infants, shape (k, c) each."""

    angles_rad: Any
    speeds_rad_s: Any


class FeltHinges:
    """Reads angles and speeds of some hinges of k infants: as proprioception tells them, or else as they are.

    Infants without proprioception, or without some of these hinges in it, feel them as the simulation has them. Where
    proprioception does not include velocities, speeds count as 0.
    """

    def __init__(self, batch: Batch, names: Sequence[str]):
        """Look up hinges by their names in the model."""
        self._batch, self._names = batch, tuple(names)
        layout = batch.infants[0].layout(SENSE) if SENSE in batch.infants[0].senses else ()
        prefix = batch.infants[0].manifest.prefix
        own = [name.removeprefix(prefix) for name in names]  # Layouts are those of an infant that is alone.
        angles, speeds = ([f"{name} {what}" for name in own] for what in ("angle [rad]", "velocity [rad/s]"))
        self.are_sensed = set(angles) <= set(layout)
        """Whether proprioception tells of them."""
        are_speeds_sensed = self.are_sensed and set(speeds) <= set(layout)
        self._angles = self._columns(layout, angles) if self.are_sensed else None
        self._speeds = self._columns(layout, speeds) if are_speeds_sensed else None
        self._models = list[Any]()

    def __call__(self, observation: Any) -> Turned:
        """Return what the infants feel."""
        if self._angles is None or SENSE not in observation:
            return self._true()
        xp, felt = self._batch.xp, self._batch.real(observation[SENSE])
        angles_rad = xp.take(felt, self._angles, axis=1)
        return Turned(angles_rad, 0.0 * angles_rad if self._speeds is None else xp.take(felt, self._speeds, axis=1))

    def _columns(self, layout: Sequence[str], names: Sequence[str]) -> Any:
        return self._batch.put(np.array([layout.index(name) for name in names], np.intp))

    def _true(self) -> Turned:
        batch, read = self._batch, self._batch.read
        infants = [batch.infants[0]] if read else list(batch.infants)
        models = [infant.model for infant in infants]
        if len(models) != len(self._models) or any(map(operator.is_not, models, self._models)):
            self._models = models
            joints = [[model.joint(name) for name in self._names] for model in models]
            self._places = [np.array([joint.qposadr[0] for joint in row], np.intp) for row in joints]
            self._dofs = [np.array([joint.dofadr[0] for joint in row], np.intp) for row in joints]
        if read:
            places, dofs = batch.put(self._places[0]), batch.put(self._dofs[0])
            return Turned(batch.xp.take(read("qpos"), places, axis=1), batch.xp.take(read("qvel"), dofs, axis=1))
        rows = zip(infants, self._places, self._dofs, strict=True)
        values = [(infant.data.qpos[places], infant.data.qvel[dofs]) for infant, places, dofs in rows]
        return Turned(*(np.stack(column) for column in zip(*values, strict=True)))
