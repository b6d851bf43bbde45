"""What the user of a bundle should know of how it was built."""

from collections.abc import Iterator

from mimoc.scenes.spec import SceneSpec
from mimoc.schema.infant import InfantSpec
from mimoc.tasks import TASKS
from mimoc.toys.choosing import Toybox


def notes(spec: InfantSpec, toybox: Toybox, target: str | None = None) -> tuple[str, ...]:
    """Return the notes of a bundle, for its README and manifest.

    Args:
        spec: What was built.
        toybox: What its toys were chosen from.
        target: The software that it was built for, if not for mimoc alone.
    """
    built_for = (f"built for {target}: parts, joints and commands are as its code wants",) if target else ()
    return (*built_for, *_task_notes(spec), *(toybox.notes if spec.scene.toys else ()))


def _task_notes(spec: InfantSpec) -> Iterator[str]:
    if spec.task and TASKS[spec.task.kind].poses == () and spec.scene.pose != SceneSpec().pose:
        yield f"'{spec.task.kind}' starts from a pose of its own; 'scene.pose: {spec.scene.pose}' has no effect"
