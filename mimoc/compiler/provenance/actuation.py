"""Where each number of the actuators comes from, and of the joints as they leave them."""

from collections.abc import Iterator

from mimoc.actuation.setup import ActuationSetup, Origin
from mimoc.body import BodyTree
from mimoc.body.origins import Entry

MODEL_KEY = "spec.actuation.model"
UNITS = {"stiffness": "N m/rad", "damping": "N m s/rad"}
"""What an actuation model may change of a joint."""


def trace_actuation(model: str, tree: BodyTree, setup: ActuationSetup, entries: dict[str, Entry]) -> dict[str, Entry]:
    """Return the entries of a body, with those of its actuators, and of the joints as an actuation model leaves them.

    Args:
        model: The actuation model.
        tree: The body.
        setup: What the actuation model makes of it.
        entries: Those of the body and its motors.
    """
    unknown = Origin(f"set by the actuation model '{model}'", (MODEL_KEY,))
    entries = {**entries, **dict(_trace_shared(setup)), **dict(_trace_joints(tree, setup, unknown))}
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
    return entries


def _trace_shared(setup: ActuationSetup) -> Iterator[tuple[str, Entry]]:
    """Yield an entry for each number that all actuators share and whose origin is told."""
    for attribute, value in setup.defaults:
        if origin := setup.origins.get(f"actuator.{attribute}"):
            yield f"actuator.{attribute}", origin.entry(float(value), f"infant.xml: default/general/@{attribute}")


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
                yield key, setup.origins.get(key, unknown).entry(value, xml, UNITS[attribute])


def _xml(actuator: str, attribute: str) -> str:
    return f"infant.xml: general[@name='{actuator}']/@{attribute}"
