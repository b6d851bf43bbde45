"""An infant in a few sentences."""

from collections.abc import Iterator

from mimoc.bundle.io import Bundle
from mimoc.reporting import words
from mimoc.tasks import TASKS

NOUNS = {"male": "A boy", "female": "A girl", None: "An infant, the mean of boys and girls,"}
POSES = {"standing": "stands", "sitting": "sits", "supine": "lies on its back", "prone": "lies on its belly"}


def described(bundle: Bundle) -> tuple[str, ...]:
    """Return what an infant is, where it is and what it is to do."""
    return tuple(_sentences(bundle))


def _sentences(bundle: Bundle) -> Iterator[str]:
    manifest = bundle.manifest
    child = manifest.child
    length, weight = words.quantity(child.length_cm, "cm"), words.quantity(child.weight_kg, "kg")
    head = words.quantity(child.head_circumference_cm, "cm")
    noun = f"{NOUNS[child.sex]} {words.of_age(child.age_months)}"
    yield f"{noun}, {length} long and {weight} heavy, with a head of {head} around."
    begins = POSES.get(manifest.pose, f'takes the pose "{words.name(manifest.pose)}"')
    toys = f" among {words.count(len(manifest.toys), 'toy')}" if manifest.toys else ""
    yield f"At the start of an episode it {begins}{toys}. {_task(bundle)}"


def _task(bundle: Bundle) -> str:
    kind = bundle.manifest.task.kind
    if kind == "free":
        return "It has no task."
    about = (TASKS[kind].spec.__doc__ or "").strip().splitlines() if kind in TASKS else []
    return f"Its task, {words.name(kind)}: {about[0][:1].lower() + about[0][1:]}" if about else f"Its task: {kind}."
