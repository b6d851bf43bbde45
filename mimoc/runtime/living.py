"""What lives of an infant in its environment, and its state."""

from dataclasses import dataclass
from typing import Any

import mujoco

from mimoc.bundle.manifest import Manifest
from mimoc.delays.schedule import Schedule
from mimoc.model_fields import ModelFields
from mimoc.noise.streams import NoiseStreams
from mimoc.runtime.constraints import Constraints
from mimoc.runtime.physics_state import physics_of, set_physics, time_of
from mimoc.tasks.task import Task


@dataclass(frozen=True, slots=True)
class Living:
    """What lives of an infant, bound to a model."""

    manifest: Manifest
    model: mujoco.MjModel
    data: mujoco.MjData
    constraints: Constraints
    fields: ModelFields
    task: Task
    schedule: Schedule
    noise: NoiseStreams

    @property
    def state(self) -> dict[str, Any]:
        """All that its next steps depend on, but for what the environment counts and draws."""
        return {
            "physics": physics_of(self.model, self.data),
            "signals": self.schedule.state,
            "model": self.fields.state,
            "task": self.task.state,
            "noise": self.noise.state,
        }

    def check(self, state: dict[str, Any]) -> None:
        """Check what is on its way in a state whose form is right.

        Raises:
            ValueError: If it cannot be restored, or a KeyError if something is missing.
        """
        self.schedule.check(state["signals"], time_of(state["physics"]))

    def restore(self, state: dict[str, Any]) -> None:
        """Restore a state, which is not kept."""
        self.fields.state, self.task.state = state["model"], state["task"]
        set_physics(self.model, self.data, state["physics"])
        self.schedule.state, self.noise.state = state["signals"], state["noise"]
