"""Where each number of the world around an infant comes from: its scene, its toys, and what its task needs."""

from collections.abc import Iterator

from mimoc.body.origins import Entry
from mimoc.compiler.furnish import FurnishedScene
from mimoc.mjcf.objects import FreeObject
from mimoc.schema.infant import InfantSpec
from mimoc.toys.objects import mass_entry, trace_toys


def trace_world(spec: InfantSpec, furnished: FurnishedScene) -> dict[str, Entry]:
    """Return an entry for each number of a world; those drawn at random name the stream of the seed they are from."""
    return {
        "scene.gravity": {
            "value": furnished.scene.world.gravity_m_s2,
            "unit": "m/s2",
            "rule": "the earth's; 0 in an empty world, and where a task takes it away",
            "from": ["spec.scene.kind"],
            "xml": "scene.xml: option/@gravity",
        },
        **furnished.origins,
        **(trace_toys(furnished.toys) if spec.scene.toys else {}),
        **{key: entry for thing in furnished.task_objects for key, entry in _trace_task_object(thing)},
    }


def _trace_task_object(thing: FreeObject) -> Iterator[tuple[str, Entry]]:
    key, at = f"task_object.{thing.name}", f"scene.xml: body[@name='{thing.name}']"
    sources = ["spec.task.kind", "spec.age_months"]
    yield f"{key}.size", {"value": thing.size_m, "unit": "m", "rule": "that of MIMo's task", "from": sources}
    yield f"{key}.mass", mass_entry(thing, [f"{key}.size"])
    rule = "where the task begins, by the body of the infant"
    yield f"{key}.pos", {"value": thing.pos_m, "unit": "m", "rule": rule, "from": sources, "xml": f"{at}/@pos"}
