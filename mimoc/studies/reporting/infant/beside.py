"""An infant beside another one: what joints can do on either side, where the two differ."""

from collections.abc import Iterator, Mapping

import mujoco

from mimoc.base.quantities.child import JOINT_RANGE, PEAK_TORQUE
from mimoc.base.units import rad_to_deg
from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_model
from mimoc.runtime.limits import torque_limits
from mimoc.studies.reporting import words
from mimoc.studies.reporting.page import Cell, Section, TextBlock, number, table


def beside(bundle: Bundle, other: Bundle, name: str) -> Section:
    """Return the section on an infant beside its counterpart, such as the `healthy` one, a row for each joint.

    Raises:
        ModelError: If MuJoCo rejects a model.
    """
    headings = ("joint", PEAK_TORQUE.heading, name, JOINT_RANGE.heading, name)
    rows = list(_rows(_joints(bundle), _joints(other)))
    if not rows:
        text = "Strength and range of all joints are the same; what differs is sensed, or is said by 'mimoc explain'."
        return Section("beside", f"Beside the {name} child", (TextBlock(text),))
    said = "Joints that differ; of all others, either side is as strong and moves as far."
    return Section("beside", f"Beside the {name} child", (TextBlock(said), table(headings, rows)))


def _joints(bundle: Bundle) -> dict[str, tuple[str, str]]:
    model: mujoco.MjModel = load_model(bundle)
    joints = {}
    for joint, limits_nm in torque_limits(bundle).items():
        low, high = (rad_to_deg(float(limit)) for limit in model.joint(joint).range)
        reach = f"{words.signed(low, 0)} to {words.signed(high, 0)}"
        joints[joint] = (words.torques(limits_nm), reach)
    return joints


def _rows(one: Mapping[str, tuple[str, str]], other: Mapping[str, tuple[str, str]]) -> Iterator[tuple[Cell, ...]]:
    """Yield a row for each joint that differs, in the order of the joints, left and right below each other."""
    for joint in other:
        before, now = other[joint], one.get(joint, ("not there", ""))
        if before != now:
            name = Cell(words.sentence(words.name(joint.removeprefix("robot:"))))
            yield name, number(now[0]), number(before[0]), number(now[1]), number(before[1])
