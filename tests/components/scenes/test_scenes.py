import math
from functools import cache

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.base.errors import SpecError
from mimoc.base.kinds import function_of
from mimoc.compiler import building
from mimoc.compiler.looks.wallpaper import Wallpapers
from mimoc.compiler.mjcf.scene import Keyframe
from mimoc.compiler.placing import place_discs, place_pose
from mimoc.compiler.scenes import BuiltScene, Occupant, Placement, footprint
from mimoc.components.scenes.room import CLEARANCE_M
from mimoc.schema.kinds import SCENES
from mimoc.schema.scene import SceneSpec


def compiled(kind: str) -> mujoco.MjModel:
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "scene": {"kind": kind}}
    files = mimoc.build(mimoc.InfantSpec.model_validate(spec)).files
    return mujoco.MjModel.from_xml_string(files["scene.xml"].decode(), assets=dict(files))


@pytest.mark.parametrize("kind", SCENES)
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


def test_toys_need_a_scene_with_a_floor(tmp_path):
    path = tmp_path / "x.yaml"
    path.write_text("mimoc: 1\nname: x\nage_months: 9\nscene: {kind: empty, toys: {}}\n")
    said = r"scene\.toys: toys require scene\.kind: flat or crib or room; change it, or remove the toys"
    with pytest.raises(SpecError, match=said):
        mimoc.load_spec(path)


def test_a_dropped_infant_stays_above_the_floor():
    model = compiled("flat")
    data = mujoco.MjData(model)
    data.qpos[2] += 0.2
    mujoco.mj_step(model, data, nstep=400)
    assert data.xpos[1:, 2].min() > 0


def around(kind: str, age_months: float, seed: int = 0) -> tuple[building.Builder, BuiltScene]:
    """Return an infant, and the world around it."""
    infant = grown(age_months)
    scene = SceneSpec.model_validate({"kind": kind, "seed": seed})
    build = function_of(SCENES[kind].build, "build")
    return infant, build(scene, Occupant(infant.tree, taken(age_months)), Wallpapers())


@cache
def grown(age_months: float) -> building.Builder:
    return building.builder(mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": age_months}))


@cache
def taken(age_months: float) -> np.ndarray:
    infant = grown(age_months)
    return footprint(infant.tree, [pose.qpos for pose in infant.infant.keyframes])


@pytest.mark.parametrize("kind", ["empty", "flat", "crib"])
def test_only_a_room_has_the_infant_elsewhere_than_in_the_middle(kind):
    assert around(kind, 9, seed=5)[1].start == Placement(0, 0, 0)


@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_an_infant_in_any_pose_fits_between_the_bars_of_its_crib(age_months):
    setting = around("crib", age_months)[1]
    discs = taken(age_months)
    free_m = setting.half_size_m - (np.abs(discs[:, :2]) + discs[:, 2:])
    assert free_m.min() >= 0.01 - 1e-9


@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_an_infant_in_a_room_is_clear_of_the_walls_in_every_pose(age_months):
    """In a thousand usual rooms, which all are wide enough."""
    for seed in range(1000 if age_months == 9 else 100):
        setting = around("room", age_months, seed)[1]
        discs = place_discs(taken(age_months), setting.start)
        assert (np.abs(discs[:, :2]) + discs[:, 2:] <= np.array(setting.half_size_m) - CLEARANCE_M + 1e-9).all()


def test_the_walls_of_a_room_are_where_its_floor_ends():
    setting = around("room", 9)[1]
    front, left = (
        next(geom for geom in setting.world.furniture.geoms if geom.name == f"wall_{side}")
        for side in ("front", "left")
    )
    assert setting.half_size_m == (front.pos_m[0], left.pos_m[1])


def test_what_is_put_elsewhere_is_turned_about_the_vertical_and_moved():
    pose = Keyframe("x", (0.1, 0.0, 0.3, math.cos(0.4), 0.0, math.sin(0.4), 0.0, 0.7))
    there = place_pose(pose, Placement(2.0, -1.0, math.pi / 2))
    assert there.qpos[:3] == pytest.approx((2.0, -0.9, 0.3))
    turn = np.empty(4)
    mujoco.mju_axisAngle2Quat(turn, [0, 0, 1], math.pi / 2)
    expected = np.empty(4)
    mujoco.mju_mulQuat(expected, turn, np.array(pose.qpos[3:7]))
    assert there.qpos[3:7] == pytest.approx(expected)
    assert there.qpos[7:] == pose.qpos[7:]
    assert place_pose(pose, Placement(0, 0, 0)) == pose


def test_what_an_infant_takes_up_moves_with_it():
    infant, there = grown(9), Placement(1.0, -2.0, 2.5)
    elsewhere = footprint(infant.tree, [place_pose(pose, there).qpos for pose in infant.infant.keyframes])
    assert place_discs(taken(9), there) == pytest.approx(elsewhere)
