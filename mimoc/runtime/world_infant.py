"""An infant in a world that it shares with others."""

from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any

import mujoco
import numpy as np
from gymnasium.utils.seeding import np_random

from mimoc.actuation.binding import bind_actuation
from mimoc.actuation.voice import Voice
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import in_subtrees
from mimoc.bundle.variants import Variant
from mimoc.companions.binding import bind_companions
from mimoc.delays.schedule import Schedule
from mimoc.delays.timing import timing_of
from mimoc.noise.noise import NoiseStreams
from mimoc.runtime.infant_view import InfantView
from mimoc.runtime.observer import NO_OBSERVER
from mimoc.runtime.simulation_state import SimulationState
from mimoc.runtime.spaces import action_space, observation_space
from mimoc.senses.binding import bind_senses
from mimoc.senses.custom import by_name
from mimoc.senses.sense import Observation
from mimoc.tasks.task import bind_task

STEPS, RANDOM = "steps", "random"
"""What a state says of an infant besides its simulation."""


class WorldInfant(InfantView):
    """An infant that is bound to a model in which others are as well; its world steps it.

    What reads an environment of one infant, such as a policy without training, can read this.
    """

    def __init__(
        self,
        bundle: Bundle,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        task: Any = None,
        senses: Mapping[str, Any] | None = None,
        companions: Mapping[str, Any] | None = None,
    ):
        """Look up its names in the model.

        Args:
            bundle: The infant, whose names have its prefix.
            model: All infants, in which no episode has changed anything yet.
            data: The state of the model.
            task: Object that replaces the bundle's task.
            senses: Objects that are added to the bundle's senses, by name.
            companions: Objects that act in its world as well, by name.
        """
        self.closed, self.bundle, self.data, self._infant = False, bundle, data, Variant(bundle, model)
        self.random, seed = np_random()
        self.noise, self.observer, self._steps = NoiseStreams(seed), NO_OBSERVER, 0
        self._act = bind_actuation(self.manifest.actuation, model)
        self._senses = bind_senses(bundle, model, custom=by_name(senses or {}))
        self._task = bind_task(bundle, model, task)
        self.voice = voice = Voice(self.manifest.actuation.voice) if self.manifest.actuation.voice else None
        beside = bind_companions(
            model, bundle, self.noise, by_name(companions or {}, "companions", "name"), self._senses, voice
        )
        timing = timing_of(self.manifest, self._senses)
        self._schedule = Schedule(self._senses, self._act, model, timing, self.noise, beside, voice)
        self._living = SimulationState.bound(self.bundle, model, data, self._task, self._schedule, self.noise)
        self.action_space = action_space(self._act, voice is not None)
        self.observation_space = observation_space(self._senses, self._task)
        root = in_subtrees(model, [model.body(self.manifest.root_body).id])
        self._qpos = np.concatenate(
            [_addresses(model, joint) for joint in np.flatnonzero(root[model.jnt_bodyid]).tolist()]
        )
        self._actuators = np.flatnonzero(root[model.jnt_bodyid[model.actuator_trnid[:, 0]]])
        active = self._actuators[model.actuator_actadr[self._actuators] >= 0]
        self._act_at = model.actuator_actadr[active]

    simulation: Any = None
    """The world that it shares with others."""

    def get_state(self) -> dict[str, Any]:
        """Return the complete state of its world."""
        return self.simulation.get_state()

    def set_state(self, state: Mapping[str, Any]) -> Observation:
        """Restore a state of its world, and return what this infant observes."""
        self.simulation.set_state(state)
        return self.observe()

    @property
    def living(self) -> SimulationState:
        """What lives of it."""
        return self._living

    @cached_property
    def rest(self) -> np.ndarray:
        """The action that commands nothing, shape (n,)."""
        return np.clip(0.0, self.action_space.low, self.action_space.high).astype(np.float32)

    def hear(self, others: Sequence[Voice]) -> None:
        """Hear the voices of other infants as well."""
        for sense in self._senses.values():
            sense.listen_to(self._schedule.companions, self.voice, others)

    def seed(self, seed: int) -> None:
        """Draw random numbers as an environment of this infant alone does from this seed on."""
        self.random, _ = np_random(seed)
        self.noise.restart(seed)

    def take_pose(self, keyframe: str) -> None:
        """Have the pose of a keyframe of the model, at its place there, in a state that has just been reset."""
        model, data, key = self._infant.bare, self.data, self._infant.bare.key(keyframe)
        data.qpos[self._qpos] = key.qpos[self._qpos]
        data.act[self._act_at] = key.act[self._act_at]
        data.ctrl[self._actuators] = model.key_ctrl[key.id][self._actuators]

    def start(self) -> None:
        """Start its task in a state that an episode begins with, with all that is derived from it."""
        self._steps = 0
        self._task.start(self.data, self.random)

    def observe(self) -> Observation:
        """Return what its senses and its task give, as fresh arrays."""
        return self._observe()

    @property
    def state(self) -> dict[str, Any]:
        """All that its next steps depend on but the physics."""
        counters = {STEPS: self._steps, RANDOM: self.random.bit_generator.state}
        return {**self._living.state_of_infant, **counters}

    def restore_counters(self, state: Mapping[str, Any]) -> None:
        """Restore what a state says besides its simulation."""
        self._steps, self.random.bit_generator.state = state[STEPS], state[RANDOM]

    def close(self) -> None:
        """Free what its senses hold."""
        for sense in self._senses.values():
            sense.close()
        self.closed = True


def _addresses(model: mujoco.MjModel, joint: int) -> np.ndarray:
    """Return where the coordinates of a joint stand in qpos."""
    is_free = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE
    return model.jnt_qposadr[joint] + np.arange(7 if is_free else 1)
