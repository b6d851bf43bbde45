"""Binding of the task in a manifest to a model."""

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.kinds import function_of
from mimoc.tasks import TASKS
from mimoc.tasks.task import Task


def bind_task(bundle: Bundle, model: mujoco.MjModel) -> Task:
    """Return the task of a bundle, with its names looked up in *model*."""
    entry = bundle.manifest.task
    return function_of(TASKS[entry.kind].run, "bind")(entry, model, bundle)
