"""What is in water floats, sinks and is slowed by known laws; all else moves as without it, to the bit."""

import copy
import math
import pickle
from contextlib import closing

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from scipy.optimize import brentq
from support.furnished import spec_with

import mimoc
from mimoc.base.errors import MimocError, SpecError
from mimoc.bundle.model import load_model
from mimoc.components.objects.water import Water
from mimoc.runtime.opening import shared_world

FAR = {"x_cm": 150, "y_cm": 0}
"""A place that the infant, which lies at the origin, does not reach."""
SENSES = {"proprioception": {"include": ["velocity"]}, "vestibular": {}}
BATH = {"name": "bath", "kind": "water"}
NOTHING = {"water": mimoc.Companion()}
"""What acts instead of the water: nothing."""


def make(objects, companions=None, **others):
    spec = spec_with(objects, **{"senses": SENSES, **others})
    env = mimoc.make(spec, companions=companions or {})
    env.reset(seed=0)
    return closing(env.unwrapped)


def rest(env, seconds: float) -> None:
    """Let time pass without commands."""
    for _ in range(round(100 * seconds)):  # Control steps of 10 ms.
        env.step(np.zeros(env.action_space.shape, np.float32))
    assert not env.data.warning.number.any()


@pytest.mark.parametrize("density_kg_m3", [200, 500, 850])
def test_a_ball_floats_as_deep_as_archimedes_says(density_kg_m3):
    """The cap below the surface, t radii above the middle, has the ball's weight: (2 + 3 t - t³) / 4 of its volume."""
    radius_m, depth_m = 0.04, 0.5
    bath = {**BATH, "depth_cm": 50, "at": FAR}
    ball = {"name": "ball", "shape": "sphere", "radius_cm": 4, "density_kg_m3": density_kg_m3, "at": "on bath"}
    with make([bath, ball]) as env:
        rest(env, 4)
        heights = []
        for _ in range(200):
            rest(env, 0.01)
            heights.append(env.data.body("object_ball").xpos[2])
        t = brentq(lambda t: (2 + 3 * t - t**3) / 4 - density_kg_m3 / 1000, -1, 1)
        below_m = depth_m - np.mean(heights) + radius_m
        assert below_m == pytest.approx(radius_m * (1 + t), rel=0.05)


def test_a_heavy_ball_sinks_at_its_terminal_speed():
    """Weight less buoyancy is drag: V (r - 1) g = C A v² / 2, with the drag coefficient C = 1 of MuJoCo's spheres."""
    bath = {**BATH, "depth_cm": 200, "at": FAR}
    ball = {"name": "ball", "shape": "sphere", "radius_cm": 2, "density_kg_m3": 2000, "at": "on bath"}
    expected_m_s = math.sqrt(8 * 0.02 * 9.81 * (2 - 1) / 3)
    with make([bath, ball]) as env:
        rest(env, 1)
        speed_m_s = -env.data.joint("object_ball_free").qvel[2]
        assert env.data.body("object_ball").xpos[2] > 0.1, "it is still sinking"
        assert speed_m_s == pytest.approx(expected_m_s, rel=0.05)


def test_water_slows_a_kick():
    """Its drag grows with the square of the speed: a fast kick has less than half of its speed in air after 50 ms."""
    speeds = []
    for companions in ({}, NOTHING):
        with make([BATH], companions, age_months=6, start_at="bath", held=["hip"]) as env:
            joint = env.data.joint("robot:right_hip1")
            joint.qvel[0] = -15.0
            rest(env, 0.05)
            speeds.append(-joint.qvel[0])
    assert 0 < speeds[0] < 0.5 * speeds[1]


def test_an_infant_floats_with_its_face_at_the_surface_or_lies_on_the_bottom_by_its_density():
    heights_m = {}
    for density in (900, 1100):
        with make([{**BATH, "depth_cm": 40, "infant_kg_m3": density}], start_at="bath") as env:
            before_m = env.data.body("chest").xipos[2]
            rest(env, 3)
            heights_m[density] = env.data.body("chest").xipos[2], before_m
    assert heights_m[900][0] > 0.3
    assert heights_m[1100][0] == pytest.approx(heights_m[1100][1], abs=0.03)


def test_what_is_not_in_water_moves_as_without_it_to_the_bit():
    objects = [{**BATH, "at": FAR}, {"name": "ball", "shape": "sphere", "at": {"x_cm": 30, "y_cm": 40, "z_cm": 30}}]
    with make(objects) as wet, make(objects, NOTHING) as dry:
        generator = np.random.default_rng(0)
        for _ in range(60):
            action = generator.uniform(-1, 1, wet.action_space.shape).astype(np.float32)
            ours, theirs = wet.step(action)[0], dry.step(action)[0]
            assert all((ours[name] == theirs[name]).all() for name in ours)
        assert (wet.data.qpos == dry.data.qpos).all()


def test_what_stands_beside_the_water_at_its_height_is_not_in_it():
    objects = [{**BATH, "at": FAR, "sides_cm": [40, 40]}]
    beside = {"name": "ball", "shape": "sphere", "density_kg_m3": 100, "at": {"x_cm": 120, "y_cm": 0}}
    within = {**beside, "at": {"x_cm": 150, "y_cm": 0, "z_cm": 0}}
    heights_m = []
    for ball in (beside, within):
        with make([*objects, ball]) as env:
            rest(env, 1)
            heights_m.append(env.data.body("object_ball").xpos[2])
    assert heights_m[0] < 0.05
    assert heights_m[1] > 0.19


@settings(max_examples=40, deadline=None)
@given(
    st.lists(st.floats(0.01, 0.1), min_size=3, max_size=3),
    st.lists(st.floats(-1, 1), min_size=4, max_size=4).filter(lambda quat: np.linalg.norm(quat) > 0.1),
    st.floats(-0.12, 0.12),
)
def test_share_and_centre_of_an_ellipsoid_below_the_surface_are_those_of_its_points(half_axes, quat, height_m):
    model, turn, water = mujoco.MjModel.from_xml_string("<mujoco/>"), np.zeros(9), Water()
    mujoco.mj_kinematics(model, data := mujoco.MjData(model))
    mujoco.mju_quat2Mat(turn, np.array(quat) / np.linalg.norm(quat))
    turn = turn.reshape(3, 3)
    centre = np.array([0.1, -0.2, height_m])
    water._half_axes = np.array([half_axes])
    far = np.array([10.0, 10.0, 10.0])
    low, high = -far, np.array([10.0, 10.0, 0.0])
    share, place = water._immersed(turn[None], centre[None], data, 0, low, high)
    grid = np.stack(np.meshgrid(*3 * [np.linspace(-1, 1, 41)]), axis=-1).reshape(-1, 3)
    points = centre + (grid[np.linalg.norm(grid, axis=1) <= 1] * half_axes) @ turn.T
    below = points[points[:, 2] < 0]
    assert share[0] == pytest.approx(len(below) / len(points), abs=0.03)
    if share[0] > 0.05:
        assert place[0] == pytest.approx(below.mean(axis=0), abs=0.05 * max(half_axes))


def test_forces_of_others_stay_as_they_are():
    class Wind(mimoc.Companion):
        def bind(self, model, bundle, generator):
            self.body = model.body("head").id

        def reset(self, data):
            data.xfrc_applied[self.body] = (1.0, 0.1, 0.2, 0.3, 0.4, 0.5)

    with make([BATH], {"wind": Wind()}, start_at="bath") as env:
        rest(env, 0.05)
        assert env.data.xfrc_applied[env.model.body("head").id] == pytest.approx((1.0, 0.1, 0.2, 0.3, 0.4, 0.5), abs=0)
        assert not np.delete(env.data.xfrc_applied, env.model.body("head").id, axis=0).any()


def test_an_infant_in_water_is_the_same_from_a_state_and_copied():
    with make([BATH], start_at="bath", pose="sitting") as env:
        rest(env, 0.2)
        state, copied = pickle.loads(pickle.dumps(env.get_state())), copy.deepcopy(env)
        rest(env, 0.2)
        after = env.data.qpos.copy()
        env.set_state(state)
        rest(env, 0.2)
        assert (env.data.qpos == after).all()
        rest(copied, 0.2)
        assert (copied.data.qpos == after).all()


def test_an_infant_in_water_is_the_same_in_a_batch_and_grows():
    bundles = [mimoc.build(spec_with([BATH], age, start_at="bath", senses=SENSES)) for age in (6, 12)]
    with closing(mimoc.make_vec(bundles, 2, threads=1)) as batch:
        batch.reset(seed=[3, 4])
        singles = [mimoc.make(item) for item in bundles]
        for seed, env in enumerate(singles, start=3):
            env.reset(seed=seed)
        actions = np.random.default_rng(0).uniform(-1, 1, (5, *batch.action_space.shape)).astype(np.float32)
        for action in actions:
            together = batch.step(action)[0]
            for index, env in enumerate(singles):
                alone = env.step(action[index])[0]
                assert all((together[name][index] == values).all() for name, values in alone.items())
        singles[0].unwrapped.grow(to=9)
        rest(singles[0].unwrapped, 0.1)
        for env in singles:
            env.close()


def test_in_plain_mujoco_water_is_only_seen():
    bundle = mimoc.build(spec_with([BATH], start_at="bath"))
    model = load_model(bundle)
    assert (model.opt.density, model.opt.viscosity) == (0.0, 0.0)
    assert (model.geom("object_bath").contype[0], model.geom("object_bath").conaffinity[0]) == (0, 0)
    assert 0 < model.mat_rgba[model.geom("object_bath").matid[0], 3] < 1


@pytest.mark.extras
def test_devices_refuse_water():
    from mimoc.runtime.device import signals

    with (
        make([BATH], start_at="bath") as env,
        pytest.raises(MimocError, match="companion 'water' acts on the CPU only"),
    ):
        signals.check_infant(env)


def test_furniture_in_water_stands_on_the_floor_and_things_begin_on_the_surface():
    table = {"name": "table", "kind": "table", "sides_cm": [20, 20], "top_cm": 30, "at": FAR}
    ball = {"name": "ball", "shape": "sphere", "at": {"x_cm": 180, "y_cm": 0}}
    bundle = mimoc.build(spec_with([{**BATH, "at": FAR}, table, ball]))
    model = load_model(bundle)
    assert model.body("object_table").pos[2] == 0.0
    assert model.body("object_ball").pos[2] == pytest.approx(0.2 + model.geom("object_ball").size[0])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"depth_cm": 0.5}, "depth_cm"),
        ({"infant_kg_m3": 100}, "infant_kg_m3"),
        ({"temperature_deg": 37}, "temperature_deg: unknown key"),
        ({"above": "chest"}, "furniture stands on the floor"),
    ],
)
def test_what_water_cannot_be_is_one_line(changes, message, tmp_path):
    keys = ", ".join(f"{key}: {value}" for key, value in {"name": "bath", "kind": "water", **changes}.items())
    path = tmp_path / "x.yaml"
    path.write_text(f"mimoc: 1\nname: x\nage_months: 9\nscene:\n  objects:\n    - {{{keys}}}\n")
    with pytest.raises(SpecError) as refusal:
        mimoc.load_spec(path)
    assert len(refusal.value.problems) == 1
    assert message in str(refusal.value)
    assert ":6:" in str(refusal.value)


def test_water_lifts_all_infants_of_a_world_by_what_they_displace():
    plain = mimoc.InfantSpec(mimoc=1, name="a", age_months=6, body={"skin": False})
    bath = {**BATH, "sides_cm": [300, 300], "depth_cm": 200, "at": {"x_cm": 0}}
    env = shared_world(mimoc.build_world({"a": plain, "b": plain.with_(age_months=12)}, scene={"objects": [bath]}))
    model, water = env.model, env.infants["a"].companions["water"]
    water.before_step(env.data)
    for infant in env.infants.values():
        root = model.body(infant.manifest.root_body).id
        lift_n = env.data.xfrc_applied[model.body_rootid == root, 2].sum()
        assert lift_n == pytest.approx(9.81 * model.body_subtreemass[root] * 1000 / 980, rel=1e-3)
    assert "water" not in env.infants["b"].companions
    env.close()
