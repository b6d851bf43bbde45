"""How light and how heavy joints are to turn."""

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.components.actuation.position.build import inertias
from mimoc.fits import measure


@pytest.mark.parametrize(("hands", "apart"), [("mitten", 1e-6), ("five_finger", 0.05)])
def test_both_sides_are_as_heavy(hands, apart):
    """But for the axis of one metacarpal, which is no mirror of the other (MIMo)."""
    found = inertias(grow_tree(measure(9), assemble(hands, False)))
    for joint, (least, largest) in found.items():
        assert 0 < least <= largest
        assert found[joint.replace("left_", "right_")] == pytest.approx((least, largest), rel=apart)


def test_mujoco_finds_no_joint_less_than_a_third_as_heavy_in_any_pose():
    """Few poses are looked at; the diagonal of the mass matrix of others stays near what they give."""
    spec = mimoc.InfantSpec(mimoc=1, name="x", age_months=9)
    model = mujoco.MjModel.from_xml_string(mimoc.build(spec).files["infant.xml"].decode(), assets=_assets(spec))
    data, generator = mujoco.MjData(model), np.random.default_rng(0)
    found = inertias(grow_tree(measure(9), assemble("mitten", False)))
    joints = [model.joint(name) for name in found]
    least = np.array(list(found.values()))[:, 0]
    for _ in range(50):
        for joint in joints:
            data.qpos[joint.qposadr[0]] = generator.uniform(*joint.range)
        mujoco.mj_forward(model, data)
        inertia = np.array([_inertia(model, data, joint.dofadr[0]) for joint in joints])
        assert (inertia > least / 3).all()


def _assets(spec: mimoc.InfantSpec) -> dict[str, bytes]:
    return {name: content for name, content in mimoc.build(spec).files.items() if name.startswith("assets/")}


def _inertia(model: mujoco.MjModel, data: mujoco.MjData, dof: int) -> float:
    """Return what a unit of acceleration about a joint takes at rest, all other joints kept as they are."""
    unit, force = np.zeros(model.nv), np.zeros(model.nv)
    unit[dof] = 1
    mujoco.mj_mulM(model, data, force, unit)
    return float(force[dof])
