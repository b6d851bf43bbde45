"""Our own kinematics, used before there is a model, agree with MuJoCo's."""

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.body.kinematics import pose
from mimoc.fits import measure

TREES = {hands: grow_tree(measure(9), assemble(hands, False)) for hands in ("mitten", "five_finger")}
TREE = TREES["mitten"]
HANDS = st.sampled_from(sorted(TREES))

angles_rad = st.floats(-1.5, 1.5)
directions = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1)


@settings(max_examples=40)
@given(hands=HANDS, data=st.data())
def test_parts_are_where_mujoco_has_them(hands, data, infant_at):
    model, tree = infant_at(9, hands).model, TREES[hands]
    values = data.draw(st.lists(angles_rad, min_size=len(tree.joints), max_size=len(tree.joints)))
    data = mujoco.MjData(model)
    data.qpos[:7] = 0, 0, 0, 1, 0, 0, 0
    data.qpos[7:] = values
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    posed = pose(tree, dict(zip(tree.joints, values, strict=True)))
    for geom, centre, turn in zip(posed.geoms, posed.centres, posed.rotations, strict=True):
        assert centre == pytest.approx(data.geom(geom.name).xpos, abs=1e-7), geom.name
        assert turn == pytest.approx(data.geom(geom.name).xmat.reshape(3, 3), abs=1e-7), geom.name
    assert posed.centre_of_mass == pytest.approx(data.subtree_com[1], abs=1e-7)


@given(hands=HANDS, direction=directions)
def test_a_standing_body_reaches_as_far_as_its_compiled_geoms(hands, direction, infant_at):
    infant, tree = infant_at(9, hands), TREES[hands]
    unit = np.array(direction) / np.linalg.norm(direction)
    geoms = [geom for geom in tree.geoms if infant.model.geom(geom).group == 0]
    _, farthest_m = infant.span_m(unit, geoms)
    hip_m = infant.data.body("hip").xpos @ unit
    assert pose(tree, {}).extent(unit) == pytest.approx(farthest_m - hip_m, abs=1e-7)


def test_only_what_collides_is_solid():
    """The neck only fills a gap."""
    standing = pose(TREE, {})
    assert {geom.name for geom in standing.geoms} - {geom.name for geom in standing.solid.geoms} == {"neck"}
