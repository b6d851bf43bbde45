"""What lives of an infant in its environment, and its state."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.actuation.arousal import Arousal
from mimoc.base.model_fields import ModelFields
from mimoc.base.state_form import check_finite, check_form, demand
from mimoc.bundle.face import Face
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import begin
from mimoc.bundle.physics_state import STATE, physics_of, set_physics, time_of
from mimoc.delays.schedule import Schedule
from mimoc.noise.noise import NoiseStreams
from mimoc.runtime.constraints import Constraints
from mimoc.runtime.expression import expression_fields, face_of
from mimoc.runtime.objects import NOWHERE, Objects, Pose
from mimoc.senses.sense import FloatArray
from mimoc.tasks.task import Task


@dataclass(frozen=True, slots=True)
class SimulationState:
    """What lives of an infant, bound to a model."""

    manifest: Manifest
    model: mujoco.MjModel
    data: mujoco.MjData
    constraints: Constraints
    objects: Objects
    fields: ModelFields
    task: Task
    schedule: Schedule
    noise: NoiseStreams
    arousal: Arousal
    face: Face | None

    @classmethod
    def bound(
        cls,
        bundle: Bundle,
        model: mujoco.MjModel,
        data: mujoco.MjData,
        task: Task,
        schedule: Schedule,
        noise: NoiseStreams,
    ) -> "SimulationState":
        """Find in a model, in which no episode has changed anything yet, what episodes change."""
        manifest, face = bundle.manifest, face_of(bundle)
        constraints, arousal = Constraints(manifest.constraints, model), Arousal(manifest.actuation, model)
        objects, of_face = Objects(manifest, model), expression_fields(face, model)
        changed = *constraints.model_fields, *task.model_fields, *of_face, *objects.model_fields
        fields = ModelFields(model, (*changed, *schedule.companions.model_fields))
        return cls(manifest, model, data, constraints, objects, fields, task, schedule, noise, arousal, face)

    def start(self, pose: str, chance: np.random.Generator, elsewhere: Mapping[str, Pose] = NOWHERE) -> None:
        """Put the infant into a pose, at rest, and start its task; some objects may be elsewhere (`Objects.start`).

        Raises:
            ModelError: If there are more contacts than in any scene.
        """
        mujoco.mj_resetDataKeyframe(self.model, self.data, self.model.key(pose).id)
        self.objects.start(self.data, elsewhere)
        mujoco.mj_kinematics(self.model, self.data)
        self.constraints.keep(self.data)
        begin(self.model, self.data)
        self.task.start(self.data, chance)
        self.start_signals()

    def start_signals(self) -> None:
        """Let companions begin, and forget all signals, in a state that an episode starts from.

        Raises:
            KindError: If a sense or the task does not observe what it says.
        """
        self.schedule.companions.reset(self.data)
        self.schedule.reset(self.data)
        self.task.check_observation()

    @property
    def state(self) -> dict[str, Any]:
        """All that its next steps depend on, but for what the environment counts and draws."""
        before = {"before": self.schedule.companions.before} if self.schedule.companions else {}
        return {"physics": physics_of(self.model, self.data), **before, **self.state_of_infant}

    @property
    def state_of_infant(self) -> dict[str, Any]:
        """The same without the physics, which several infants can have in common."""
        companions = {"companions": self.schedule.companions.state} if self.schedule.companions else {}
        return {
            "signals": self.schedule.state,
            "model": self.fields.state,
            "task": self.task.state,
            "noise": self.noise.state,
            "arousal": self.arousal.level,
            **companions,
        }

    def model_as_built(self) -> mujoco.MjModel:
        """Return a copy of the model in which no episode has changed anything."""
        level, self.arousal.level = self.arousal.level, self.arousal.as_built
        built = self.fields.model_as_built()
        self.arousal.level = level
        return built

    @contextmanager
    def checked(self, state: Any, valid: Mapping[str, Any]) -> Iterator[None]:
        """Restore a state within that can be that of this infant; *valid* is one that is.

        Raises:
            ValueError: If it cannot be, or cannot be restored; the message says where.
        """
        try:
            check_form(state, _lasting(valid))
            self.schedule.check(state["signals"], time_of(state["physics"]))
            yield
        except (AttributeError, IndexError, KeyError, OverflowError, TypeError) as error:
            raise ValueError(f"this state cannot be restored ({error}); give one that get_state returned") from error

    def restore(self, state: dict[str, Any]) -> None:
        """Restore a state, which is not kept."""
        self.restore_model(state)
        set_physics(self.model, self.data, state["physics"])
        self.restore_signals(state)
        if self.schedule.companions:
            self._restore_before(state["before"], state["physics"])

    def _restore_before(self, before: FloatArray, physics: FloatArray) -> None:
        """Restore the bodies and contacts that companions see, those of the state before the last physics step."""
        size = mujoco.mj_stateSize(self.model, STATE)
        demand(isinstance(before, np.ndarray) and before.shape in ((0,), (size,)), "before", before)
        check_finite(before, "before")
        self.schedule.companions.before = before
        if len(before):
            mujoco.mj_setState(self.model, self.data, before, STATE)
            mujoco.mj_step(self.model, self.data)
            mujoco.mj_setState(self.model, self.data, physics, STATE)

    def restore_model(self, state: dict[str, Any]) -> None:
        """Restore what a state says of the model and the task, before the physics."""
        self.fields.state, self.task.state = state["model"], state["task"]
        self.arousal.level = state["arousal"]

    def restore_signals(self, state: dict[str, Any]) -> None:
        """Restore what a state says of signals, noise and companions, after the physics."""
        self.schedule.state, self.noise.state = state["signals"], state["noise"]
        if self.schedule.companions:
            self.schedule.companions.state = state["companions"]


def _lasting(state: Mapping[str, Any]) -> dict[str, Any]:
    """Return what has the same form in all states of an infant: not tasks, companions, signals, nor streams."""
    signals = {name: state["signals"][name] for name in ("noise", "motor_noise")}
    noise = {"seed": state["noise"]["seed"]}
    lasting = {name: state[name] for name in state if name not in ("task", "companions", "before")}
    return lasting | {"signals": signals, "noise": noise}
