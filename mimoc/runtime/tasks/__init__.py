"""Tasks: what an infant is rewarded for."""

from collections.abc import Mapping
from importlib import import_module

import mujoco

from mimoc.bundle import Bundle
from mimoc.runtime.fastenings import Fastenings
from mimoc.runtime.tasks.task import Task, Verdict

TASKS: Mapping[str, str] = {
    "free": "mimoc.runtime.tasks.free",
    "reach": "mimoc.runtime.tasks.reach",
    "catch": "mimoc.runtime.tasks.catch",
    "rollover": "mimoc.runtime.tasks.rollover",
    "standup": "mimoc.runtime.tasks.standup",
    "selfbody": "mimoc.runtime.tasks.selfbody",
}
"""The module of each kind of task, which has `bind`."""


def bind_task(bundle: Bundle, model: mujoco.MjModel, fastenings: Fastenings) -> Task:
    """Return the task of a bundle."""
    entry = bundle.manifest.task
    return import_module(TASKS[entry.kind]).bind(entry, bundle, model, fastenings)


__all__ = ["TASKS", "Task", "Verdict", "bind_task"]
