"""Notes for the user of a bundle on how it was built."""

from collections.abc import Iterator, Mapping

from mimoc.compiler.without_effect import without_effect
from mimoc.scenes.spec import SceneSpec
from mimoc.schema.infant import InfantSpec
from mimoc.schema.key_paths import dotted
from mimoc.schema.sizes import pairs
from mimoc.tasks import TASKS
from mimoc.toys.choosing import Toybox


def notes(spec: InfantSpec, toybox: Toybox, plugins: Mapping[str, str], target: str | None = None) -> tuple[str, ...]:
    """Return the notes of a bundle, for its README and manifest.

    Args:
        spec: The spec.
        toybox: The toys to choose from.
        plugins: Distributions of the kinds that are not part of mimoc.
        target: Name of the other software that it was built for, if any.
    """
    built_for = (f"built for {target}: parts, joints and commands are those that its code expects",) if target else ()
    of_toys = toybox.notes if spec.scene.toys else ()
    on_spec = (*_task_notes(spec), *without_effect(spec), *_said_twice(spec))
    return (*built_for, *_plugin_notes(plugins), *on_spec, *of_toys)


def _plugin_notes(plugins: Mapping[str, str]) -> Iterator[str]:
    for kind, distribution in sorted(plugins.items()):
        if distribution:
            yield f"'{kind}' is a plug-in: to build this bundle again, install '{distribution}'"
        else:
            yield f"'{kind}' is a plug-in that a script registered"


def _said_twice(spec: InfantSpec) -> Iterator[str]:
    for earlier, later, _ in pairs(spec.body, spec.age_months):
        first, second = dotted(earlier.path), dotted(later.path)
        if later.is_side_of(earlier) and later.value != earlier.value:
            yield f"'{second}' counts in place of '{first}' on that side"
        else:
            yield f"'{first}' and '{second}' say the same; one of the two is enough"


def _task_notes(spec: InfantSpec) -> Iterator[str]:
    if spec.task and TASKS[spec.task.kind].poses == () and spec.scene.pose != SceneSpec().pose:
        yield f"task '{spec.task.kind}' has its own starting pose; 'scene.pose: {spec.scene.pose}' has no effect"
