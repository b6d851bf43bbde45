"""The names of mimoc's environments, which Gymnasium knows."""

from gymnasium.envs.registration import register, registry

from mimoc.base.kinds import announced
from mimoc.schema.kinds import TASKS

INFANT = "mimoc/Infant-v0"


def env_name(task: str) -> str:
    """Return the name of the environment of a task: `mimoc/Reach-v0` for `reach`."""
    return f"mimoc/{''.join(word.capitalize() for word in task.split('_'))}-v0"


def register_envs() -> None:
    """Tell Gymnasium of all environments, those of plug-ins included; calling it again changes nothing."""
    _register_env(INFANT, "open_infant", "make_vec_infant")
    for task in (*TASKS, *announced("mimoc.tasks")):
        _register_env(env_name(task), "make_task", "make_vec_task", kind=task)


def _register_env(name: str, one: str, many: str, **keywords: str) -> None:
    if name not in registry:
        for_many = f"mimoc.runtime.opening.vector_environments:{many}"
        register(name, f"mimoc.runtime.opening.environments:{one}", vector_entry_point=for_many, kwargs=keywords)
