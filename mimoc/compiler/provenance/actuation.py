"""Where each number of the actuators comes from, and of the joints as they leave them."""

from collections.abc import Iterator

from mimoc.actuation.setup import ActuationSetup, Origin
from mimoc.body import Anatomy, BodyTree, Motor, MotorFigures
from mimoc.body.maturing.mature import maturing_groups
from mimoc.body.maturing.rules import LAW_KEY, force_range_rule, gear_rule
from mimoc.body.provenance import CONSTANT, REFERENCE, Entry

MODEL_KEY = "spec.actuation.model"
UNITS = {"stiffness": "N m/rad", "damping": "N m s/rad"}
"""What an actuation model may change of a joint."""


def trace_actuation(model: str, anatomy: Anatomy, tree: BodyTree, setup: ActuationSetup) -> dict[str, Entry]:
    """Return an entry for each number of the actuators, and for those of the joints that an actuation model changes.

    Args:
        model: The actuation model.
        anatomy: What the body was grown to.
        tree: The body.
        setup: What the actuation model makes of it.
    """
    groups = maturing_groups(anatomy)
    unknown = Origin(f"set by the actuation model '{model}'", (MODEL_KEY,))
    entries = {**dict(_trace_shared(setup)), **dict(_trace_joints(tree, setup, unknown))}
    at_18 = {motor.name.format(side=side): motor for side, motor in anatomy.motors}
    for motor in tree.motors:
        entries.update(_trace_strength(motor, at_18[motor.name], groups[motor.joint], tree))
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
                entries[key] = _entry(value, origin, _xml(actuator.name, attribute))
    return entries


def _trace_shared(setup: ActuationSetup) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each number that all actuators share and whose origin is told."""
    for attribute, value in setup.defaults:
        if origin := setup.origins.get(f"actuator.{attribute}"):
            yield f"actuator.{attribute}", _entry(float(value), origin, f"infant.xml: default/general/@{attribute}")


def _trace_joints(tree: BodyTree, setup: ActuationSetup, unknown: Origin) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each spring and damper that is not as the body has it."""
    for name, joint in setup.joints.items():
        was = tree.joints[name]
        changes = {
            "stiffness": (was.stiffness_nm_per_rad, joint.stiffness_nm_per_rad),
            "damping": (was.damping_nms_per_rad, joint.damping_nms_per_rad),
        }
        for attribute, (before, value) in changes.items():
            if value != before:
                key, xml = f"joint.{name}.{attribute}", f"infant.xml: joint[@name='{name}']/@{attribute}"
                yield key, {**_entry(value, setup.origins.get(key, unknown), xml), "unit": UNITS[attribute]}


def _trace_strength(motor: Motor, figures: MotorFigures, group: str, tree: BodyTree) -> Iterator[tuple[str, Entry]]:
    """Yield a motor's gear, with what makes it stronger or weaker than it has grown, and its force range."""
    rule = (
        f"{figures.gear_nm:g} N m ({REFERENCE}) x volume / volume of the average child of 18 months, "
        f"of the geom that moves the joint: {motor.mover}"
    )
    sources, range_rule = [f"geom.{motor.mover}.size"], None
    if tree.growth:
        of_age = gear_rule(figures.name, group, tree.age_months, tree.growth)
        rule, sources = rule + of_age.text, [*sources, *of_age.sources]
        range_rule = force_range_rule(figures.name, group, tree.age_months)
    else:
        rule, sources = f"{rule}, by the law `published`", [*sources, LAW_KEY]
    rule += "".join(f" x {factor:.6g} ({key})" for key, factor in motor.factors)
    sources += [key for key, _ in motor.factors]
    yield f"actuator.{motor.name}.gear", {"value": motor.gear_nm, "unit": "N m", "rule": rule, "from": sources}
    limits: Entry = {"value": motor.force_range, "unit": "1", "rule": range_rule.text if range_rule else CONSTANT}
    if range_rule:
        limits["from"] = list(range_rule.sources)
    yield f"actuator.{motor.name}.forcerange", limits


def _entry(value: float | tuple[float, ...], origin: Origin, xml: str) -> Entry:
    entry: Entry = {"value": value, "rule": origin.rule, "xml": xml}
    if origin.unit:
        entry["unit"] = origin.unit
    if origin.sources:
        entry["from"] = list(origin.sources)
    return entry


def _xml(actuator: str, attribute: str) -> str:
    return f"infant.xml: general[@name='{actuator}']/@{attribute}"
