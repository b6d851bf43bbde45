import mujoco
import pytest

import mimoc
from mimoc.scene.world import WORLDS


def compiled(kind: str) -> mujoco.MjModel:
    spec = {"mimo": 1, "name": "x", "age_months": 9, "scene": {"kind": kind}}
    files = mimoc.build(mimoc.InfantSpec.model_validate(spec)).files
    return mujoco.MjModel.from_xml_string(files["scene.xml"].decode(), assets=dict(files))


@pytest.mark.parametrize("kind", WORLDS)
def test_every_world_has_light_and_all_poses(kind):
    model = compiled(kind)
    assert model.nlight >= 1
    assert model.nkey == 4


def test_a_flat_world_is_a_floor_at_zero_under_gravity():
    model = compiled("flat")
    floor = model.geom("floor")
    assert floor.type[0] == mujoco.mjtGeom.mjGEOM_PLANE
    assert list(floor.pos) == [0, 0, 0]
    assert list(model.opt.gravity) == [0, 0, -9.81]


def test_in_an_empty_world_the_infant_floats():
    model = compiled("empty")
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    start = data.subtree_com[1].copy()
    mujoco.mj_step(model, data, nstep=100)
    assert data.ncon == 0
    assert data.subtree_com[1] == pytest.approx(start, abs=1e-3), "springs pull limbs, nothing pulls the whole"


def test_a_dropped_infant_stays_above_the_floor():
    model = compiled("flat")
    data = mujoco.MjData(model)
    data.qpos[2] += 0.2
    mujoco.mj_step(model, data, nstep=400)
    assert data.xpos[1:, 2].min() > 0
