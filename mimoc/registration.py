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
    _register_env(INFANT, "open_infant", "make_vec_infant")
    for task in (*TASKS, *announced("mimoc.tasks")):
        _register_env(env_name(task), "make_task", "make_vec_task", kind=task)


def _register_env(name: str, one: str, many: str, **keywords: str) -> None:
    if name not in registry:
        for_many = f"mimoc.vector_environments:{many}"
        register(name, f"mimoc.environments:{one}", vector_entry_point=for_many, kwargs=keywords)


def register_formatters() -> None:
    """Let notebooks show a bundle as a picture with its measures; outside of IPython this does nothing."""
    shell = sys.modules["IPython"].get_ipython() if "IPython" in sys.modules else None
    if shell is not None:
        shell.display_formatter.formatters["text/html"].for_type_by_name("mimoc.bundle.io", "Bundle", _bundle_html)


def _bundle_html(bundle: "Bundle") -> str:
    from mimoc.notebook import bundle_html

    return bundle_html(bundle)
