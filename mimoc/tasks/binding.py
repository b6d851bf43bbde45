"""Tasks: what an infant is rewarded for."""

from collections.abc import Mapping
from importlib import import_module

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.runtime.fastenings import Fastenings
from mimoc.tasks.task import Task, Verdict

TASKS: Mapping[str, str] = {
    "free": "mimoc.tasks.free.run",
    "reach": "mimoc.tasks.reach.run",
    "catch": "mimoc.tasks.catch.run",
    "rollover": "mimoc.tasks.rollover.run",
    "standup": "mimoc.tasks.standup.run",
    "selfbody": "mimoc.tasks.selfbody.run",
}
"""The module of each kind of task, which has `bind`."""


def bind_task(bundle: Bundle, model: mujoco.MjModel, fastenings: Fastenings) -> Task:
    """Return the task of a bundle."""
    entry = bundle.manifest.task
    return import_module(TASKS[entry.kind]).bind(entry, bundle, model, fastenings)


__all__ = ["TASKS", "Task", "Verdict", "bind_task"]
