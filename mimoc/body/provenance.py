"""Provenance of each number of a body, as its entries in a bundle."""

import math
from collections.abc import Iterator, Mapping

from mimoc.anatomy.part import ReferencePart
from mimoc.anatomy.published_figures import as_published
from mimoc.base.units import m_to_cm
from mimoc.body.grow import GrownBody
from mimoc.body.joints import joint_origins
from mimoc.body.origins import Entry, Origin
from mimoc.body.strength import motor_origins
from mimoc.body.tree import Body, BodyTree, Geom, Joint
from mimoc.fits import Measurements, load_tables
from mimoc.schema.names import SIDES


def trace_body(grown: GrownBody, tree: BodyTree, scaled: Mapping[str, tuple[str, ...]]) -> dict[str, Entry]:
    """Return an entry for each number of a body, by key; *scaled* are keys that scale a part, by body."""
    anatomy, child = grown.reference.anatomy, grown.measurements
    figures = {geom.name.format(side=side): geom for side, part in anatomy.parts for geom in part.geoms}
    parts = {part.name.format(side=side): (side, part) for side, part in anatomy.parts}
    hinges = {joint.name.format(side=side): joint for side, part in anatomy.parts for joint in part.joints}
    at_18 = {motor.name.format(side=side): motor for side, motor in anatomy.motors}
    motors = {motor.joint: motor.name for motor in tree.motors}
    groups = anatomy.groups
    entries = dict(_trace_measurements(child))
    if anatomy.development == "published":
        for name in load_tables().published:
            entries[f"measurements.{name}_cm"]["rule"] += as_published("curves")
    for body in tree.bodies:
        side, part = parts[body.name]
        movers = _moving(body, part, scaled)
        entries |= _trace_body(body, part, _keys(part.position_from, side, child, movers))
        for geom in body.geoms:
            solid = figures[geom.name]
            sized, placed = (
                _keys(names, side, child, scaled.get(body.name, ()))
                for names in (solid.size_from, (*solid.size_from, *solid.position_from))
            )
            mass = grown.masses.origin(solid, part, geom.name, sized)
            entries |= _trace_geom(geom, Origin(solid.rule, sized), Origin(solid.rule, placed), mass)
        for joint in body.joints:
            motor = motors.get(joint.name)
            origins = joint_origins(joint, hinges[joint.name], groups[joint.name], motor, tree)
            entries |= _trace_joint(joint, origins)
    for motor in tree.motors:
        gear, limits = motor_origins(motor, at_18[motor.name], groups[motor.joint], tree)
        entries[f"actuator.{motor.name}.gear"] = gear.entry(motor.gear_nm, unit="N m")
        entries[f"actuator.{motor.name}.forcerange"] = limits.entry(motor.force_range, unit="1")
    return entries


def _moving(body: Body, part: ReferencePart, scaled: Mapping[str, tuple[str, ...]]) -> tuple[str, ...]:
    """Return the keys of the spec that move a body: those that scale its parent, or what it has to keep clear of."""
    movers = (body.parent or "", *((body.name, part.keeps_clear_of) if part.keeps_clear_of else ()))
    return tuple(dict.fromkeys(key for mover in movers for key in scaled.get(mover, ())))


def _trace_measurements(measurements: Measurements) -> Iterator[tuple[str, Entry]]:
    for name, measured in measurements.table.items():
        entry = Origin(measured.origin, measured.given_by, "cm").entry(m_to_cm(measured.value_m))
        if curve := measured.curve:
            entry["rule"] += ": a log(age_months + b) + c + d age_months" if curve.d else ": a log(age_months + b) + c"
            entry["fit"] = {"a": curve.a, "b": curve.b_months, "c": curve.c, **({"d": curve.d} if curve.d else {})}
            entry["points"] = [
                {"age_months": point.age_months, "value_cm": point.value_cm, "origin": point.origin}
                for point in measured.points
            ]
        yield f"measurements.{name}_cm", entry


def _trace_body(body: Body, part: ReferencePart, sources: tuple[str, ...]) -> dict[str, Entry]:
    at, key = _xml("body", body.name), f"body.{body.name}"
    mass = Origin("sum of its geoms", tuple(f"geom.{geom.name}.mass" for geom in body.geoms), "kg")
    entries = {f"{key}.mass": mass.entry(body.mass_kg, f"{at}/geom/@mass")}
    if body.parent:
        entries[f"{key}.pos"] = Origin(part.rule, sources, "m").entry(body.pos_m, f"{at}/@pos")
    return entries


def _trace_geom(geom: Geom, size: Origin, pos: Origin, mass: Origin) -> dict[str, Entry]:
    key, at = f"geom.{geom.name}", _xml("geom", geom.name)
    return {
        f"{key}.size": size.entry(geom.size_m, f"{at}/@size", "m"),
        f"{key}.pos": pos.entry(geom.pos_m, f"{at}/@pos", "m"),
        f"{key}.mass": mass.entry(geom.mass_kg, f"{at}/@mass", "kg"),
    }


def _trace_joint(joint: Joint, origins: Mapping[str, Origin]) -> dict[str, Entry]:
    low, high = joint.range_deg
    constants = {
        "range": ((math.radians(low), math.radians(high)), "rad"),
        "stiffness": (joint.stiffness_nm_per_rad, "N m/rad"),
        "damping": (joint.damping_nms_per_rad, "N m s/rad"),
        "frictionloss": (joint.frictionloss_nm, "N m"),
        "armature": (joint.armature_kgm2, "kg m2"),
        "springref": (math.radians(joint.springref_deg), "rad"),
        **{attribute: (value, "rad") for attribute, value in joint.settings},
    }
    at = _xml("joint", joint.name)
    return {
        f"joint.{joint.name}.{attribute}": origins[attribute].entry(value, f"{at}/@{attribute}", unit)
        for attribute, (value, unit) in constants.items()
    }


def _keys(names: tuple[str, ...], side: str, measurements: Measurements, scaled: tuple[str, ...]) -> tuple[str, ...]:
    """Return the keys that a number depends on: measurements of its side where the spec gives them, else of both."""
    sides = (side,) if side else SIDES

    def of_side(name: str) -> tuple[str, ...]:
        sided = tuple(f"{side}_{name}" for side in sides if f"{side}_{name}" in measurements.table)
        return sided if len(sided) == len(sides) else (name,)

    return (*(f"measurements.{key}_cm" for name in names for key in of_side(name)), *scaled)


def _xml(tag: str, name: str) -> str:
    return f"infant.xml: {tag}[@name='{name}']"
