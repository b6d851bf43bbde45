"""What other programs know of mimoc: Gymnasium the names of its environments, IPython how bundles are shown."""

import sys
from typing import TYPE_CHECKING

from gymnasium.envs.registration import register, registry

from mimoc.kinds import announced
from mimoc.tasks import TASKS

if TYPE_CHECKING:
    from mimoc.bundle.io import Bundle
import base64
from html import escape

from mimoc.bundle.io import Bundle
from mimoc.compiler.provenance import AMONG, who_percentiles
from mimoc.errors import RenderingError
from mimoc.render.picture_files import encoded
from mimoc.render.portrait import portrait

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
    from mimoc.registration import bundle_html

    return bundle_html(bundle)


PICTURE_PX = (320, 240)
MEASURES = {
    "length_cm": ("length", "cm"),
    "weight_kg": ("weight", "kg"),
    "head_circumference_cm": ("head circumference", "cm"),
    "arm_circumference_cm": ("arm circumference", "cm"),
}


def bundle_html(bundle: Bundle) -> str:
    """Return a picture of an infant, if one can be drawn here, and its measures with WHO's percentiles."""
    child, percentiles = bundle.manifest.child, who_percentiles(bundle.manifest.child)
    rows = [
        (name, f"{value:.1f} {unit}", f"{percentiles[key]:.0f}" if key in percentiles else "")
        for key, (name, unit) in MEASURES.items()
        if (value := getattr(child, key)) is not None
    ]
    heading = ("", "", f"WHO percentile, {AMONG[child.sex]}")
    table = "".join(f"<tr>{''.join(f'<td>{escape(cell)}</td>' for cell in row)}</tr>" for row in (heading, *rows))
    title = f"<b>{escape(bundle.manifest.name)}</b>, {child.age_months:g} months"
    return f"<div>{title}<br>{_picture(bundle)}<table>{table}</table></div>"


def _picture(bundle: Bundle) -> str:
    """Return a portrait as an element that contains it; nothing where there is no OpenGL."""
    try:
        png = encoded(portrait(bundle, None, *PICTURE_PX), ".png")
    except RenderingError:
        return ""
    data = base64.b64encode(png).decode()
    return f'<img alt="{escape(bundle.manifest.name)}" src="data:image/png;base64,{data}">'
