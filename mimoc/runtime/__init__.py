"""The runtime, from a bundle to a Gymnasium environment; and the names of mimoc's environments in Gymnasium."""

from mimoc.base.kinds import announced
from mimoc.schema.kinds import TASKS

INFANT = "mimoc/Infant-v0"


def env_name(task: str) -> str:
    """Return the name of the environment of a task: `mimoc/Reach-v0` for `reach`."""
    return f"mimoc/{''.join(word.capitalize() for word in task.split('_'))}-v0"


def register_envs() -> None:
    """Register all environments with Gymnasium, those of plug-ins included; calling it again changes nothing."""
    from gymnasium.envs.registration import register, registry  # Importing them calls this (`mimoc/__init__.py`).

    def add(name: str, one: str, many: str, **keywords: str) -> None:
        if name not in registry:
            for_many = f"mimoc.runtime.vector_opening:{many}"
            register(name, f"mimoc.runtime.opening:{one}", vector_entry_point=for_many, kwargs=keywords)

    add(INFANT, "open_infant", "make_vec_infant")
    for task in (*TASKS, *announced("mimoc.tasks")):
        add(env_name(task), "make_task", "make_vec_task", kind=task)
