"""Where each number of the actuators comes from, and of the joints as they leave them."""

from collections.abc import Callable, Iterator, Mapping

from mimoc.actuation.drives import Drive
from mimoc.actuation.muscle.build import DAMPING, LONGEST, PEAK, SHORTEST
from mimoc.actuation.position.build import FINEST_STEP_S, LAG_S, STEPS_OF_LAG
from mimoc.body import Anatomy, BodyTree, Motor
from mimoc.body.provenance import CONSTANT, REFERENCE, Entry
from mimoc.mjcf.tree import Actuator

MODEL_KEY, STEP_KEY = "spec.actuation.model", "spec.control.timestep_ms"
STROKE = LONGEST - SHORTEST
"""By how much a muscle's length changes over the range of its joint, in optimal lengths."""


def trace_drive(model: str, anatomy: Anatomy, tree: BodyTree, drive: Drive) -> dict[str, Entry]:
    """Return an entry for each number of the actuators, and for those of the joints that an actuation model changes.

    Args:
        model: The actuation model.
        anatomy: What the body was grown to.
        tree: The body.
        drive: What drives it.
    """
    gears_nm = {motor.name.format(side=side): motor.gear_nm for side, motor in anatomy.motors}
    entries: dict[str, Entry] = {}
    for name, joint in drive.joints.items():
        was = tree.joints[name]
        if joint.stiffness_nm_per_rad != was.stiffness_nm_per_rad:
            entries.update(_trace_joint(name, "stiffness", joint.stiffness_nm_per_rad, "N m/rad", model, ()))
        if joint.damping_nms_per_rad != was.damping_nms_per_rad:
            sources = _speed_keys(tree, name) if model == "position" else ()
            entries.update(_trace_joint(name, "damping", joint.damping_nms_per_rad, "N m s/rad", model, sources))
    for motor in tree.motors:
        mine = [actuator for actuator in drive.actuators if actuator.mimo_actuator == motor.name]
        entries.update(TRACES.get(model, _trace_strength)(tree, motor, gears_nm[motor.name], mine))
    return entries


def _trace_joint(
    name: str, attribute: str, value: float, unit: str, model: str, sources: tuple[str, ...]
) -> Iterator[tuple[str, Entry]]:
    rules = {
        ("muscle", "stiffness"): f"{REFERENCE}, but none with muscles",
        ("muscle", "damping"): f"{REFERENCE}, x {DAMPING:g} with muscles",
        ("position", "damping"): _DAMPING_RULE,
    }
    xml = f"infant.xml: joint[@name='{name}']/@{attribute}"
    entry = {"value": value, "unit": unit, "rule": rules[model, attribute], "from": [MODEL_KEY, *sources], "xml": xml}
    yield f"joint.{name}.{attribute}", entry


def _trace_torque(
    tree: BodyTree, motor: Motor, reference_nm: float, actuators: list[Actuator]
) -> Iterator[tuple[str, Entry]]:
    for key, entry in _trace_strength(tree, motor, reference_nm, actuators):
        yield key, {**entry, "xml": _xml(motor.name, key.split(".")[-1])}
    (actuator,) = actuators
    rule = f"VMAX ({REFERENCE}), both FMAX = {PEAK:g} x gear x part of forcerange x range of the joint / {STROKE:g}"
    strength = [f"actuator.{motor.name}.gear", f"actuator.{motor.name}.forcerange", f"joint.{motor.joint}.range"]
    entry = {"value": dict(actuator.settings)["user"], "rule": rule, "from": strength}
    yield f"actuator.{motor.name}.user", {**entry, "xml": _xml(motor.name, "user")}


def _trace_strength(
    tree: BodyTree, motor: Motor, reference_nm: float, actuators: list[Actuator]
) -> Iterator[tuple[str, Entry]]:
    """Yield a motor's gear, with what makes it stronger or weaker than it has grown, and its force range."""
    rule = (
        f"{reference_nm:g} N m ({REFERENCE}) x volume / volume of the average child of 18 months, "
        f"of the geom that moves the joint: {motor.mover}"
    )
    rule += "".join(f" x {factor:.6g} ({key})" for key, factor in motor.factors)
    sources = [f"geom.{motor.mover}.size", *(key for key, _ in motor.factors)]
    yield f"actuator.{motor.name}.gear", {"value": motor.gear_nm, "unit": "N m", "rule": rule, "from": sources}
    yield f"actuator.{motor.name}.forcerange", {"value": motor.force_range, "unit": "1", "rule": CONSTANT}


def _trace_muscles(
    tree: BodyTree, motor: Motor, reference_nm: float, actuators: list[Actuator]
) -> Iterator[tuple[str, Entry]]:
    yield from _trace_strength(tree, motor, reference_nm, actuators)
    rule = (
        f"lengths at the ends of the joint's range, largest isometric torque in N m = {PEAK:g} x gear x part of "
        f"forcerange, MuJoCo's scale, lengths where active, vmax ({REFERENCE}), passive and lengthening force"
    )
    strength = [f"actuator.{motor.name}.gear", f"actuator.{motor.name}.forcerange"]
    for actuator in actuators:
        numbers = dict(actuator.settings)
        at = f"actuator.{actuator.name}"
        for attribute in ("gainprm", "biasprm"):
            entry = {"value": numbers[attribute], "rule": rule, "from": strength, "xml": _xml(actuator.name, attribute)}
            yield f"{at}.{attribute}", entry
        length = {"value": numbers["lengthrange"], "unit": "rad", "rule": "the range of its joint, as it pulls"}
        xml = _xml(actuator.name, "lengthrange")
        yield f"{at}.lengthrange", {**length, "from": [f"joint.{motor.joint}.range"], "xml": xml}


_DAMPING_RULE = (
    f"peak torque / speed at which its muscles do not pull (vmax ({REFERENCE}) x range / {LONGEST - SHORTEST:.2f}), "
    "where that is more than the reference body's"
)
_STOP_RULE = f"least inertia about the joint / physics step (of {1000 * FINEST_STEP_S:g} ms at least)"
_STIFFNESS_RULE = (
    f"({_STOP_RULE} + damping of the joint) / lag ({LAG_S:g} s, and {STEPS_OF_LAG} physics steps at least)"
)


def _trace_servos(
    tree: BodyTree, motor: Motor, reference_nm: float, actuators: list[Actuator]
) -> Iterator[tuple[str, Entry]]:
    yield from _trace_strength(tree, motor, reference_nm, actuators)
    rules = {
        "forcerange": "gear x part of it that is reached towards negative and positive angles: "
        f"{motor.force_range[0]:g} and {motor.force_range[1]:g} ({REFERENCE})",
        "gainprm": f"{_STIFFNESS_RULE} x half of the joint's range",
        "biasprm": f"torque at angle 0, then by angle: -{_STIFFNESS_RULE}, less the joint's own spring, and by speed: "
        f"-{_STOP_RULE}",
    }
    joint = [f"joint.{motor.joint}.{constant}" for constant in ("range", "stiffness", "springref", "damping")]
    gains = [*joint, f"joint.{motor.joint}.armature", STEP_KEY, *_masses_on(tree, motor.joint)]
    for actuator in actuators:
        for attribute, value in actuator.settings:
            key, strong = f"actuator.{actuator.name}.{attribute}", attribute == "forcerange"
            entry = {"value": value, "rule": rules[attribute], "xml": _xml(actuator.name, attribute)}
            sources = [f"actuator.{motor.name}.gear"] if strong else gains
            yield key, {**entry, **({"unit": "N m"} if strong else {}), "from": sources}


def _speed_keys(tree: BodyTree, joint: str) -> tuple[str, ...]:
    """Return the keys of what a servo's speed follows."""
    gears = tuple(f"actuator.{motor.name}.gear" for motor in tree.motors if motor.joint == joint)
    return (*gears, f"joint.{joint}.range")


def _masses_on(tree: BodyTree, joint: str) -> list[str]:
    """Return the keys of the masses that a joint moves."""
    moved: list[str] = []
    for body in tree.bodies:
        if body.parent in moved or joint in [hinge.name for hinge in body.joints]:
            moved.append(body.name)
    return [f"body.{name}.mass" for name in moved]


def _xml(actuator: str, attribute: str) -> str:
    return f"infant.xml: general[@name='{actuator}']/@{attribute}"


TRACES: Mapping[str, Callable[[BodyTree, Motor, float, list[Actuator]], Iterator[tuple[str, Entry]]]] = {
    "torque": _trace_torque,
    "muscle": _trace_muscles,
    "position": _trace_servos,
}
"""By actuation model."""
