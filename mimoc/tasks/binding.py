"""The task of an environment: that of a bundle, or an object that a script passes instead, which needs no record."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import gymnasium
import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.kinds import check_custom_object, function_of
from mimoc.model_fields import ModelField
from mimoc.senses.sense import Observation
from mimoc.tasks import TASKS
from mimoc.tasks.task import Judgement, Task


def bind_task(bundle: Bundle, model: mujoco.MjModel, custom: Any = None) -> Task:
    """Return the task of a bundle, or an object that replaces it, with its names looked up in *model*.

    Raises:
        KindError: If the object is a class, or has no `judge`.
    """
    if custom is not None:
        return CustomTask(custom, model, bundle)
    entry = bundle.manifest.task
    return function_of(TASKS[entry.kind].run, "bind")(entry, model, bundle)


class CustomTask(Task):
    """A task defined by a user's object, which is not part of a bundle.

    The object has `judge(data, action, effort)`, which returns a `Judgement` or the reward alone. It can also have
    `bind(model, bundle)`, called whenever a model was loaded; `start(data, generator)`, called at each reset;
    `observe()` and `spaces`, its part of the observation; `steps`, after which an episode is truncated, without which
    those of the bundle's task hold; `state`, a dictionary that can be read and set, with everything that it stores
    within an episode; and, if it is a `Task`, a `term` that judges.
    """

    def __init__(self, custom: Any, model: mujoco.MjModel, bundle: Bundle):
        """Bind the object to a model.

        Raises:
            KindError: If it is a class, or has no `judge`.
        """
        check_custom_object("task", custom, "judge", "an object such as a mimoc.Task")
        if hasattr(custom, "bind"):
            custom.bind(model, bundle)
        super().__init__(getattr(custom, "steps", None) or bundle.manifest.task.steps, getattr(custom, "term", None))
        self._custom = custom

    @property
    def class_name(self) -> str:
        """Class of the object, as `module:Class`."""
        return f"{type(self._custom).__module__}:{type(self._custom).__qualname__}"

    @property
    def model_fields(self) -> Sequence[ModelField]:
        """Fields of the model that it changes."""
        return getattr(self._custom, "model_fields", ())

    @property
    def spaces(self) -> Mapping[str, gymnasium.Space]:
        """Spaces of its part of the observation."""
        return getattr(self._custom, "spaces", {})

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        """Start an episode."""
        if hasattr(self._custom, "start"):
            self._custom.start(data, generator)

    def observe(self) -> Observation:
        """Return its part of the observation."""
        return self._custom.observe() if hasattr(self._custom, "observe") else {}

    def judge(self, data: mujoco.MjData, action: np.ndarray, effort: Callable[[], float]) -> Judgement:
        """Return its judgement of a control step."""
        judgement = self._custom.judge(data, action, effort)
        return judgement if isinstance(judgement, Judgement) else Judgement({"reward": float(judgement)})

    @property
    def state(self) -> dict[str, Any]:
        """Everything that it stores within an episode."""
        return getattr(self._custom, "state", {})

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        if hasattr(self._custom, "state"):
            self._custom.state = state
