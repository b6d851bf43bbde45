"""What lives of an infant in its environment, and its state."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import mujoco

from mimoc.base.model_fields import ModelFields
from mimoc.base.state_form import check_form
from mimoc.bundle.manifest import Manifest
from mimoc.delays.schedule import Schedule
from mimoc.noise.noise import NoiseStreams
from mimoc.runtime.constraints import Constraints
from mimoc.runtime.physics_state import physics_of, set_physics, time_of
from mimoc.tasks.task import Task


@dataclass(frozen=True, slots=True)
class SimulationState:
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
        self.fields.state, self.task.state = state["model"], state["task"]
        set_physics(self.model, self.data, state["physics"])
        self.schedule.state, self.noise.state = state["signals"], state["noise"]


def _lasting(state: Mapping[str, Any]) -> dict[str, Any]:
    """Return what has the same form in all states of an infant: not tasks, signals on their way, nor streams."""
    signals = {name: state["signals"][name] for name in ("noise", "motor_noise")}
    noise = {"seed": state["noise"]["seed"]}
    return {name: state[name] for name in state if name != "task"} | {"signals": signals, "noise": noise}
