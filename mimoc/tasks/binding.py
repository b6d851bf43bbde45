"""Binding of the task in a manifest to a model."""

from typing import Any

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.kinds import function_of
from mimoc.tasks import TASKS
from mimoc.tasks.custom import CustomTask
from mimoc.tasks.task import Task


def bind_task(bundle: Bundle, model: mujoco.MjModel, custom: Any = None) -> Task:
    """Return the task of a bundle, or an object that replaces it, with its names looked up in *model*."""
    if custom is not None:
        return CustomTask(custom, model, bundle)
    entry = bundle.manifest.task
    return function_of(TASKS[entry.kind].run, "bind")(entry, model, bundle)
