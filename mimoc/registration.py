"""What other programs know of mimoc: Gymnasium the names of its environments, IPython how bundles are shown."""

import sys
from typing import TYPE_CHECKING

from gymnasium.envs.registration import register, registry

from mimoc.base.kinds import announced
from mimoc.tasks import TASKS

if TYPE_CHECKING:
    from mimoc.bundle.io import Bundle

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


def register_formatters() -> None:
    """Let notebooks show a bundle as a picture with its measures; outside of IPython this does nothing."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    if shell is not None:
        shell.display_formatter.formatters["text/html"].for_type_by_name("mimoc.bundle.io", "Bundle", _bundle_html)


def _bundle_html(bundle: "Bundle") -> str:
    from mimoc.notebook import bundle_html

    return bundle_html(bundle)
