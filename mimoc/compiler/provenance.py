"""Where each number of a bundle comes from: of its spec, task and plug-ins, its world, its actuators and its child."""

import math
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from mimoc import fits
from mimoc.anatomy.parts import PARTS
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.bundle.manifest import ChildEntry
from mimoc.bundle.world import file_of
from mimoc.compiler.actuation import ActuationSetup, Origin
from mimoc.compiler.mjcf.world import FreeObject
from mimoc.compiler.placing import PlacedScene
from mimoc.compiler.toys import mass_entry, trace_toys
from mimoc.fits.standards import percentile
from mimoc.schema.body import BODYSUIT_UNTIL_MONTHS
from mimoc.schema.infant import InfantSpec
from mimoc.schema.reading import FileModel
from mimoc.schema.source import Source
from mimoc.schema.task import TaskEntry

SPEC_FILE = "spec.yaml"  # The spec in a bundle, as it was written.


def trace_spec(spec: FileModel, written: Source) -> dict[str, Entry]:
    """Return where each value of the spec was written, by key; `spec.age_months`."""
    entries = {}
    for path, value in _leaves(spec.model_dump(mode="json", exclude_none=True)):
        line, column = written.locate(path)
        rule = f"{SPEC_FILE}:{line}:{column}" if path in written.value_places else "default"
        entries[".".join(("spec", *path))] = {"value": value, "rule": rule}
    return entries


def _leaves(data: Mapping[str, Any], above: tuple[str, ...] = ()) -> list[tuple[tuple[str, ...], Any]]:
    leaves = []
    for key, value in data.items():
        path = (*above, key)
        leaves += _leaves(value, path) if isinstance(value, Mapping) else [(path, value)]
    return leaves


TASK_KEYS = ["spec.task.kind", "spec.age_months"]


def trace_task(entry: TaskEntry) -> dict[str, Entry]:
    """Return an entry for each number that the manifest tells of a task."""
    fields = type(entry).model_fields
    numbers = {name: value for name, value in entry.model_dump().items() if _is_number(value)}
    return {
        f"task.{entry.kind}.{name}": {"value": value, "rule": fields[name].description or "", "from": TASK_KEYS}
        for name, value in numbers.items()
    }


def _is_number(value: Any) -> bool:
    values = value if isinstance(value, tuple) else (value,)
    return bool(values) and all(isinstance(number, int | float) for number in values)


PLUGIN_KEYS = {
    "actuation": ["spec.actuation.model"],
    "tasks": ["spec.task.kind"],
    "scenes": ["spec.scene.kind"],
    "toys": ["spec.scene.toys.source"],
    "objects": ["spec.scene.objects"],
}
"""Key of the spec that asks for a kind; a sense is a section, which has none of its own."""


def trace_plugins(plugins: Mapping[str, str]) -> dict[str, Entry]:
    """Return an entry for each kind that is not mimoc's own: its distribution, empty if a script registered it."""
    entries: dict[str, Entry] = {}
    for kind, distribution in plugins.items():
        rule = "the installed distribution that declares this kind" if distribution else "registered by a script"
        section, _, name = kind.partition(".")
        sources = PLUGIN_KEYS.get(section, [])
        if section == "parts":
            sources = ["spec.body.hands" if PARTS[name].replaces else "spec.body.extra"]
        entries[f"plugins.{kind}"] = {"value": distribution, "rule": rule, "from": sources}
    return entries


def trace_world(spec: InfantSpec, furnished: PlacedScene) -> dict[str, Entry]:
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
    key = f"task_object.{thing.name}"
    at = f"scene.xml: body[@name='{thing.name}']"
    yield f"{key}.size", {"value": thing.size_m, "unit": "m", "rule": "that of MIMo's task", "from": TASK_KEYS}
    yield f"{key}.mass", mass_entry(thing, [f"{key}.size"])
    rule = "where the task begins, by the body of the infant"
    yield f"{key}.pos", {"value": thing.pos_m, "unit": "m", "rule": rule, "from": TASK_KEYS, "xml": f"{at}/@pos"}


MODEL_KEY = "spec.actuation.model"
OF_JOINTS = {
    "stiffness": ("stiffness_nm_per_rad", "N m/rad"),
    "damping": ("damping_nms_per_rad", "N m s/rad"),
    "springref": ("springref_deg", "rad"),
}
"""What an actuation model may change of a joint: its field, and its unit."""


def trace_actuation(model: str, tree: BodyTree, setup: ActuationSetup, entries: dict[str, Entry]) -> dict[str, Entry]:
    """Return the entries of a body with those of its actuators, and of its joints as an actuation model leaves them."""
    unknown = Origin(f"set by the actuation model '{model}'", (MODEL_KEY,))
    shared = {
        f"actuator.{attribute}": origin.entry(float(value), f"infant.xml: default/general/@{attribute}")
        for attribute, value in setup.defaults
        if (origin := setup.origins.get(f"actuator.{attribute}"))
    }
    entries = {**entries, **shared, **dict(_trace_joints(tree, setup, unknown))}
    strengths = {motor.name: motor for motor in tree.motors}
    for actuator in setup.actuators:
        if actuator.name in strengths and actuator.gear == strengths[actuator.name].gear_nm:
            entries[f"actuator.{actuator.name}.gear"]["xml"] = _xml(actuator.name, "gear")
        for attribute, value in actuator.settings:
            key = f"actuator.{actuator.name}.{attribute}"
            if key not in setup.origins and key in entries:
                entries[key]["xml"] = _xml(actuator.name, attribute)
            else:
                origin = setup.origins.get(key, unknown)
                entries[key] = origin.entry(value, _xml(actuator.name, attribute))
    for reflex in setup.reflexes:
        for attribute, value in (("biasprm", reflex.bias), ("forcerange", reflex.force_range)):
            key = f"actuator.{reflex.name}.{attribute}"
            entries[key] = setup.origins[key].entry(value, _xml(reflex.name, attribute))
    return entries


def _trace_joints(tree: BodyTree, setup: ActuationSetup, unknown: Origin) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each spring and damper that is not as the body has it."""
    of_body = tree.joints
    for name, joint in setup.joints.items():
        for attribute, (field, unit) in OF_JOINTS.items():
            value = getattr(joint, field)
            if value != getattr(of_body[name], field):
                key = f"joint.{name}.{attribute}"
                xml = f"infant.xml: joint[@name='{name}']/@{attribute}"
                written = math.radians(value) if unit == "rad" else value
                yield key, setup.origins.get(key, unknown).entry(written, xml, unit)


def _xml(actuator: str, attribute: str) -> str:
    return f"infant.xml: general[@name='{actuator}']/@{attribute}"


SCALE_NOT_KNOWN = "scale not known: of the average child's size, and compared with no standard"
"""What is said of the measures of a child whose size is not known."""
MEASURES = {
    "length_cm": ("cm", "crown to sole: how far the geoms reach along the vertical, no joint turned"),
    "weight_kg": ("kg", "sum of all bodies"),
    "head_circumference_cm": ("cm", "perimeter of the head's level section"),
    "arm_circumference_cm": ("cm", "2 pi x radius of the upper arm"),
}
"""Unit and rule of each measure of a child."""
AMONG = {"male": "boys", "female": "girls", None: "the mean of boys and girls"}


def trace_child(tree: BodyTree, child: ChildEntry) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each measure of a child, and for each percentile among WHO's children."""
    arms = [name for name in ("left_uarm1", "right_uarm1") if name in tree.geoms]
    sources = {
        "length_cm": ["measurements.crown_sole_length_cm"],
        "weight_kg": [f"body.{body.name}.mass" for body in tree.bodies],
        "head_circumference_cm": ["geom.head.size"],
        "arm_circumference_cm": [f"geom.{name}.size" for name in arms[:1]],
    }
    for name, (unit, rule) in MEASURES.items():
        value = getattr(child, name)
        rule += "" if child.size_is_known else f"; {SCALE_NOT_KNOWN}"
        if value is not None:
            yield f"child.{name}", {"value": value, "unit": unit, "rule": rule, "from": sources[name]}
    rule = f"WHO Child Growth Standards: among {AMONG[child.sex]} of that age"
    for name, value in who_percentiles(child).items():
        place = {"value": value, "unit": "%", "rule": rule, "from": [f"child.{name}", "spec.age_months"]}
        yield f"who.{name}.percentile", place


def trace_birth(spec: InfantSpec) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for how early a child was born, by which the age of all that matures is corrected."""
    if keys := spec.birth_keys:
        rule = "from birth to 40 weeks of gestation; strength, joints, delays and acuity are those of the age less this"
        yield "child.months_early", Origin(rule, keys, "months").entry(spec.months_early)


def trace_clothes(spec: InfantSpec) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for the clothes of a child."""
    if spec.body.looks.clothes:
        yield "child.clothes", {"value": spec.clothes, "rule": "as asked for", "from": ["spec.body.looks.clothes"]}
    else:
        rule = f"a bodysuit below {BODYSUIT_UNTIL_MONTHS:g} months of corrected age, else a shirt and trousers"
        early = ["child.months_early"] if spec.months_early else []
        yield "child.clothes", {"value": spec.clothes, "rule": rule, "from": ["spec.age_months", *early]}


def who_percentiles(child: ChildEntry) -> dict[str, float]:
    """Return where a child stands among WHO's children of its age and sex, 0 to 100, by indicator.

    An indicator that WHO has no standard for at that age is left out, and all of a child whose size is not known.
    """
    if not child.size_is_known:
        return {}
    measures = child.model_dump()
    return {
        indicator: percentile(standard.z_score(measures[indicator], child.corrected_age_months, child.sex or "mean"))
        for indicator, standard in fits.load_tables().who.items()
        if standard.covers(child.corrected_age_months) and measures[indicator] is not None
    }


def trace_around(origins: Mapping[str, Entry], shared: Collection[str], infant: str) -> Iterator[tuple[str, Entry]]:
    """Yield where the numbers of what is around all infants come from, by what is said in the scene of a single infant.

    All numbers that are not *shared* belong to one *infant*.

    """
    for key, entry in origins.items():
        sources = [source if source in shared else f"{infant}.{source}" for source in entry.get("from", ())]
        yield key, {**entry, "from": sources}


def trace_infant(name: str, prefix: str, entries: Mapping[str, Entry]) -> Iterator[tuple[str, Entry]]:
    """Yield where the numbers of an infant come from, in its world, by what is said of it alone."""
    for key, entry in entries.items():
        changed = dict(entry)
        if key.startswith("spec."):
            is_shared = key.startswith("spec.scene.") and key not in ("spec.scene.pose", "spec.scene.held")
            rule = entry["rule"].replace(SPEC_FILE, file_of(name, SPEC_FILE))
            changed["rule"] = "the scene of the world" if is_shared else rule
        if "from" in entry:
            changed["from"] = [f"{name}.{source}" for source in entry["from"]]
        if "xml" in entry:
            changed["xml"] = _xml_in_world(entry["xml"], prefix)
        yield f"{name}.{key}", changed


def _xml_in_world(xml: str, prefix: str) -> str:
    if xml.startswith("scene.xml"):
        return xml  # Things of its task, whose names have their prefix already.
    in_world_file = xml.replace("infant.xml:", "scene.xml:").replace("[@name='", f"[@name='{prefix}")
    return in_world_file.replace("default/", f"default[@class='{prefix}infant']/")
