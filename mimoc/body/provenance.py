"""Provenance of each number of a body: table row, growth curve or rule."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from mimoc.body.assembly import Anatomy
from mimoc.body.density import density, is_of_fingers
from mimoc.body.figures import GeomFigures, JointFigures, Part
from mimoc.body.maturing.mass_rules import mass_rule
from mimoc.body.maturing.mature import maturing_groups, passive_scales
from mimoc.body.maturing.parts import matured
from mimoc.body.maturing.rules import LAW_KEY, REFERENCE, Rule, joint_rules
from mimoc.body.tree import Body, BodyTree, Geom, Joint
from mimoc.fits import Measured, Measurements
from mimoc.schema.names import SIDES
from mimoc.units import deg_to_rad, m_to_cm

Entry = dict[str, Any]
"""`value`, `unit`, `rule`, and if they apply `from` (keys of other entries), `fit`, `points` and `xml`."""

CONSTANT = f"{REFERENCE}; the same at every age"
PUBLISHED = f"{REFERENCE}; the same at every age by the law `published`"
CONSTANTS = ("range", "stiffness", "damping", "frictionloss", "armature", "springref")
"""A joint's attributes in MJCF that are numbers of the body."""
EXTRAORDINARY = "its motor is stronger than the average child's"
"""Reason why a joint has more damping and armature than in the reference body (`damping`)."""


def trace_body(
    measurements: Measurements, anatomy: Anatomy, tree: BodyTree, scaled: Mapping[str, tuple[str, ...]]
) -> dict[str, Entry]:
    """Return an entry for each number of a body, by key: `geom.head.size`, `measurements.foot_length_cm`.

    Args:
        measurements: Measurements that the body was grown from.
        anatomy: Anatomy of the body.
        tree: The body.
        scaled: Keys of the spec that scale a part, by name of the body.
    """
    anatomy = matured(anatomy) if tree.development == "maturing" else anatomy
    figures = {geom.name.format(side=side): geom for side, part in anatomy.parts for geom in part.geoms}
    sides = {part.name.format(side=side): side for side, part in anatomy.parts}
    parts = {part.name.format(side=side): part for side, part in anatomy.parts}
    hinges = {joint.name.format(side=side): joint for side, part in anatomy.parts for joint in part.joints}
    motors = {motor.joint: motor.name for motor in tree.motors}
    entries, groups = dict(_trace_measurements(measurements)), maturing_groups(anatomy)
    for body in tree.bodies:
        side, here = sides[body.name], scaled.get(body.name, ())
        above = _moving(body, parts[body.name], scaled)
        entries.update(_trace_body(body, parts[body.name], _keys(parts[body.name].follows, side, measurements, above)))
        for geom in body.geoms:
            sized, placed = figures[geom.name].follows, figures[geom.name].placed_by
            sources = [_keys(names, side, measurements, here) for names in (sized, (*sized, *placed))]
            entries.update(_trace_shape(geom, figures[geom.name], *sources))
            mass = _trace_mass(geom, figures[geom.name], parts[body.name], tree, sources[0])
            entries[f"geom.{geom.name}.mass"] = mass
        for joint in body.joints:
            law = _law(joint, hinges[joint.name], groups[joint.name], tree)
            entries.update(_trace_joint(joint, law, motors.get(joint.name)))
    return entries


def _moving(body: Body, part: Part, scaled: Mapping[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Return the keys of the spec that move a body: those that scale its parent, or what it has to keep clear of."""
    movers = (body.parent or "", *((body.name, part.keeps_clear_of) if part.keeps_clear_of else ()))
    return tuple(dict.fromkeys(key for mover in movers for key in scaled.get(mover, ())))


def _trace_measurements(measurements: Measurements) -> Iterator[tuple[str, Entry]]:
    for name, measured in measurements.table.items():
        entry: Entry = {
            "value": m_to_cm(measured.value_m),
            "unit": "cm",
            "rule": measured.origin,
            "from": list(measured.given_by),
        }
        if measured.curve:
            curve = measured.curve
            entry["rule"] += ": a log(age_months + b) + c + d age_months" if curve.d else ": a log(age_months + b) + c"
            entry["fit"] = {"a": curve.a, "b": curve.b_months, "c": curve.c, **({"d": curve.d} if curve.d else {})}
            entry["points"] = _points(measured)
        yield f"measurements.{name}_cm", entry


def _points(measured: Measured) -> list[Entry]:
    return [{"age_months": p.age_months, "value_cm": p.value_cm, "origin": p.origin} for p in measured.points]


def _trace_body(body: Body, part: Part, sources: list[str]) -> Iterator[tuple[str, Entry]]:
    at = _xml("body", body.name)
    yield (
        f"body.{body.name}.mass",
        {
            "value": body.mass_kg,
            "unit": "kg",
            "rule": "sum of its geoms",
            "from": [f"geom.{geom.name}.mass" for geom in body.geoms],
            "xml": at + "/geom/@mass",
        },
    )
    if body.parent:
        entry = {"value": body.pos_m, "unit": "m", "rule": part.rule, "from": sources, "xml": at + "/@pos"}
        yield f"body.{body.name}.pos", entry


def _trace_shape(geom: Geom, figures: GeomFigures, sources: list[str], place: list[str]) -> Iterator[tuple[str, Entry]]:
    key, at = f"geom.{geom.name}", _xml("geom", geom.name)
    yield (
        f"{key}.size",
        {"value": geom.size_m, "unit": "m", "rule": figures.rule, "from": sources, "xml": at + "/@size"},
    )
    yield f"{key}.pos", {"value": geom.pos_m, "unit": "m", "rule": figures.rule, "from": place, "xml": at + "/@pos"}


def _trace_mass(geom: Geom, figures: GeomFigures, part: Part, tree: BodyTree, sources: list[str]) -> Entry:
    solid = "volume of MIMo's solid with these measurements, by the growth law of the paper"
    usual = Rule(f"{density(figures, tree.hands):.6g} kg/m3 x {solid}; {_weighing(figures, tree.hands)}", (*sources,))
    rule = (tree.growth and mass_rule(geom, figures, part, tree.hands, tree.growth, sources)) or usual
    at = f"{_xml('geom', geom.name)}/@mass"
    return {"value": geom.mass_kg, "unit": "kg", "rule": rule.text, "from": list(rule.sources), "xml": at}


def _weighing(figures: GeomFigures, hands: str) -> str:
    """Return the source of the density of a geom."""
    if is_of_fingers(figures, hands):
        return f"the density of {REFERENCE}"
    return f"density such that this part of the average child of 18 months has {figures.mass_kg:g} kg, as {REFERENCE}"


@dataclass(frozen=True, slots=True)
class _Law:
    """What a joint is by the law of its age, before anything makes its motor stronger."""

    rules: Mapping[str, Rule]
    """By attribute in MJCF, of what changes with age."""
    usual: Mapping[str, float]
    """Damping and armature."""


def _law(joint: Joint, figures: JointFigures, group: str, tree: BodyTree) -> _Law:
    usual = {"damping": figures.damping_nms_per_rad, "armature": figures.armature_kgm2}
    if tree.growth is None:
        return _Law(dict.fromkeys(CONSTANTS, Rule(PUBLISHED, (LAW_KEY,))), usual)
    scales = passive_scales(joint.name, group, tree.growth)
    rules = joint_rules(figures, joint.name, group, tree.age_months, tree.growth)
    return _Law(rules, {name: value * scales[name] for name, value in usual.items()})


def _trace_joint(joint: Joint, law: _Law, motor: str | None) -> Iterator[tuple[str, Entry]]:
    """Yield entries for a joint's constants; *motor* is the motor that moves it."""
    low, high = joint.range_deg
    constants = {
        "range": ((deg_to_rad(low), deg_to_rad(high)), "rad"),
        "stiffness": (joint.stiffness_nm_per_rad, "N m/rad"),
        "damping": (joint.damping_nms_per_rad, "N m s/rad"),
        "frictionloss": (joint.frictionloss_nm, "N m"),
        "armature": (joint.armature_kgm2, "kg m2"),
        "springref": (deg_to_rad(joint.springref_deg), "rad"),
    }
    for attribute, (value, unit) in constants.items():
        rule = law.rules.get(attribute)
        entry: Entry = {"value": value, "unit": unit, "rule": rule.text if rule else CONSTANT}
        sources = list(rule.sources) if rule else []
        usual = law.usual.get(attribute)
        if usual is not None and not math.isclose(value, usual):
            start = rule.text if rule and rule.text != PUBLISHED else f"{usual:g} ({REFERENCE})"
            entry["rule"] = f"{start} x {value / usual:.6g}, by which {EXTRAORDINARY}"
            sources.append(f"actuator.{motor}.gear")
        if sources:
            entry["from"] = sources
        yield f"joint.{joint.name}.{attribute}", {**entry, "xml": f"{_xml('joint', joint.name)}/@{attribute}"}


def _keys(names: tuple[str, ...], side: str, measurements: Measurements, scaled: tuple[str, ...]) -> list[str]:
    """Return the keys that a number depends on: measurements of its side where the spec gives them, else of both."""
    sides = (side,) if side else SIDES

    def own(name: str) -> Iterator[str]:
        sided = [f"{each}_{name}" for each in sides if f"{each}_{name}" in measurements.table]
        yield from sided if len(sided) == len(sides) else (name,)

    return [*(f"measurements.{each}_cm" for name in names for each in own(name)), *scaled]


def _xml(tag: str, name: str) -> str:
    return f"infant.xml: {tag}[@name='{name}']"
