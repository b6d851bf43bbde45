"""What the user of a bundle should know of how it was built."""

from collections.abc import Iterator, Mapping

from mimoc.scenes.spec import SceneSpec
from mimoc.schema.infant import InfantSpec
from mimoc.tasks import TASKS
from mimoc.toys.choosing import Toybox


def notes(spec: InfantSpec, toybox: Toybox, plugins: Mapping[str, str], target: str | None = None) -> tuple[str, ...]:
    """Return the notes of a bundle, for its README and manifest.

    Args:
        spec: What was built.
        toybox: What its toys were chosen from.
        plugins: The kinds that are not mimoc's own, and the distribution of each.
        target: The software that it was built for, if not for mimoc alone.
    """
    built_for = (f"built for {target}: parts, joints and commands are as its code wants",) if target else ()
    return (*built_for, *_plugin_notes(plugins), *_task_notes(spec), *(toybox.notes if spec.scene.toys else ()))


def _plugin_notes(plugins: Mapping[str, str]) -> Iterator[str]:
    for kind, distribution in sorted(plugins.items()):
        if distribution:
            yield f"'{kind}' is not mimoc's own: to build this bundle again, install '{distribution}'"
        else:
            yield f"'{kind}' is not mimoc's own: a script registered it"


def _task_notes(spec: InfantSpec) -> Iterator[str]:
    if spec.task and TASKS[spec.task.kind].poses == () and spec.scene.pose != SceneSpec().pose:
        yield f"'{spec.task.kind}' starts from a pose of its own; 'scene.pose: {spec.scene.pose}' has no effect"
