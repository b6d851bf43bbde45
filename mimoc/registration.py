"""Gymnasium's names for mimoc's environments."""

from gymnasium.envs.registration import register, registry

from mimoc.kinds import announced
from mimoc.tasks import TASKS

INFANT = "mimoc/Infant-v0"


def env_name(task: str) -> str:
    """Return the name of the environment of a task: `mimoc/Reach-v0` for `reach`."""
    return f"mimoc/{''.join(word.capitalize() for word in task.split('_'))}-v0"


def register_envs() -> None:
    """Tell Gymnasium of all environments, those of plug-ins included; calling it again changes nothing."""
    if INFANT not in registry:
        register(
            id=INFANT,
            entry_point="mimoc.environments:open_infant",
            vector_entry_point="mimoc.vector_environments:make_vec_infant",
        )
    for task in (*TASKS, *announced("mimoc.tasks")):
        register_task_env(task)


def register_task_env(task: str) -> None:
    """Tell Gymnasium of the environment of one task."""
    if env_name(task) not in registry:
        register(
            id=env_name(task),
            entry_point="mimoc.environments:make_task",
            vector_entry_point="mimoc.vector_environments:make_vec_task",
            kwargs={"kind": task},
        )
