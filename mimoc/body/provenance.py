"""Where each number of a body comes from: table row, growth curve, rule."""

from collections.abc import Iterator
from typing import Any

from mimoc.body import anatomy
from mimoc.body.figures import GeomFigures, Part
from mimoc.body.strength import MOTOR_GROUPS
from mimoc.body.tree import Body, BodyTree, Geom, Joint, Motor
from mimoc.fits import Measured, Measurements
from mimoc.units import deg_to_rad, m_to_cm

Entry = dict[str, Any]
"""`value`, `unit`, `rule`, and where they apply `from` (keys of other entries), `fit`, `points` and `xml`."""

REFERENCE = "MIMo's reference body, 18 months"


def trace_body(measurements: Measurements, tree: BodyTree) -> dict[str, Entry]:
    """Return an entry for each number of a body, by key: `geom.head.size`, `measurements.foot_length_cm`."""
    figures = {
        geom.name.format(side=side): geom
        for parts, sides in anatomy.GROUPS
        for side in sides
        for part in parts
        for geom in part.geoms
    }
    parts = {part.name.format(side=side): part for parts, sides in anatomy.GROUPS for side in sides for part in parts}
    gears = {
        motor.name.format(side=side): motor.gear_nm
        for motors, sides in MOTOR_GROUPS
        for side in sides
        for motor in motors
    }
    entries = dict(_trace_measurements(measurements))
    for body in tree.bodies:
        entries.update(_trace_body(body, parts[body.name]))
        for geom in body.geoms:
            entries.update(_trace_geom(geom, figures[geom.name]))
        for joint in body.joints:
            entries.update(_trace_joint(joint))
    for motor in tree.motors:
        entries.update(_trace_motor(motor, gears[motor.name]))
    return entries


def _trace_measurements(measurements: Measurements) -> Iterator[tuple[str, Entry]]:
    for name, measured in measurements.table.items():
        yield (
            f"measurements.{name}_cm",
            {
                "value": m_to_cm(measured.value_m),
                "unit": "cm",
                "rule": f"{measured.origin}: a log(age_months + b) + c",
                "fit": {"a": measured.curve.a, "b": measured.curve.b_months, "c": measured.curve.c},
                "points": _points(measured),
                "from": ["spec.age_months"],
            },
        )


def _points(measured: Measured) -> list[Entry]:
    return [{"age_months": p.age_months, "value_cm": p.value_cm, "origin": p.origin} for p in measured.points]


def _trace_body(body: Body, part: Part) -> Iterator[tuple[str, Entry]]:
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
        entry = {"value": body.pos_m, "unit": "m", "rule": part.rule, "from": _keys(part.follows), "xml": at + "/@pos"}
        yield f"body.{body.name}.pos", entry


def _trace_geom(geom: Geom, figures: GeomFigures) -> Iterator[tuple[str, Entry]]:
    key, at = f"geom.{geom.name}", _xml("geom", geom.name)
    sources = _keys(figures.follows)
    yield (
        f"{key}.size",
        {"value": geom.size_m, "unit": "m", "rule": figures.rule, "from": sources, "xml": at + "/@size"},
    )
    yield f"{key}.pos", {"value": geom.pos_m, "unit": "m", "rule": figures.rule, "from": sources, "xml": at + "/@pos"}
    yield (
        f"{key}.mass",
        {
            "value": geom.mass_kg,
            "unit": "kg",
            "rule": f"{figures.mass_kg:g} kg ({REFERENCE}) x volume / volume of the average child of 18 months",
            "from": [f"{key}.size"],
            "xml": at + "/@mass",
        },
    )


def _trace_joint(joint: Joint) -> Iterator[tuple[str, Entry]]:
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
        rule = f"{REFERENCE}; the same at every age"
        xml = f"{_xml('joint', joint.name)}/@{attribute}"
        yield f"joint.{joint.name}.{attribute}", {"value": value, "unit": unit, "rule": rule, "xml": xml}


def _trace_motor(motor: Motor, reference_gear_nm: float) -> Iterator[tuple[str, Entry]]:
    key, at = f"actuator.{motor.name}", _xml("general", motor.name)
    yield (
        f"{key}.gear",
        {
            "value": motor.gear_nm,
            "unit": "N m",
            "rule": f"{reference_gear_nm:g} N m ({REFERENCE}) x volume / volume of the average child of 18 months, "
            f"of the geom that moves the joint: {motor.mover}",
            "from": [f"geom.{motor.mover}.size"],
            "xml": at + "/@gear",
        },
    )
    rule = f"{REFERENCE}; the same at every age"
    yield f"{key}.forcerange", {"value": motor.force_range, "unit": "1", "rule": rule, "xml": at + "/@forcerange"}


def _keys(measurements: tuple[str, ...]) -> list[str]:
    return [f"measurements.{name}_cm" for name in measurements]


def _xml(tag: str, name: str) -> str:
    return f"infant.xml: {tag}[@name='{name}']"
