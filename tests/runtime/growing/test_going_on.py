"""An infant that grows while it lives goes on where it was, with the body of its new age."""

import copy

import mujoco
import numpy as np
import pytest
from support.growing import DEEPEST_M, SENSES, deepest_m, flail, same, spec

import mimoc
from mimoc.bundle.model import load_model, simulation_warnings


def test_angles_and_velocities_are_kept_as_far_as_joints_reach(live):
    env = live(6, scene={"pose": "supine"})
    angles, speeds, root = env.data.qpos[7:].copy(), env.data.qvel.copy(), env.data.qpos[:7].copy()
    env.grow(to=6.25)
    low, high = env.model.jnt_range[1:].T
    assert env.data.qpos[7:] == pytest.approx(np.clip(angles, low, high), abs=0.05)
    assert np.array_equal(env.data.qvel, speeds)
    assert env.data.qpos[:2] == pytest.approx(root[:2], abs=1e-3)
    assert (env.data.qpos[7:] >= low - 1e-12).all()
    assert (env.data.qpos[7:] <= high + 1e-12).all()


def test_the_body_is_that_of_the_new_age(live, variants):
    env = live(6)
    env.grow(to=9.5)
    expected = load_model(mimoc.build(spec(9.5)))
    for name in ("body_mass", "geom_size", "jnt_range", "actuator_gear", "dof_damping", "key_qpos"):
        assert np.array_equal(getattr(env.model, name), getattr(expected, name)), name
    assert env.age_months == env.manifest.child.age_months == 9.5
    assert env.bundle.files == mimoc.build(spec(6).with_(age_months=9.5)).files


@pytest.mark.parametrize(
    "keys",
    [
        {"senses": {**SENSES, "touch": {"density": 0.2}}},
        {"senses": {**SENSES, "touch": {"density": 0.2, "channels": ["sa1", "ra"]}, "pain": {}}},
        {"actuation": {"model": "muscle"}},
        {"actuation": {"model": "position"}},
        {"body": {"hands": "five_finger", "chest_joint": True}},
        {"task": {"kind": "selfbody"}, "scene": {"pose": "sitting"}},
        {"development": "published"},
    ],
    ids=str,
)
def test_spaces_are_the_same_at_all_ages(variants, keys):
    found = variants(6, **keys)
    young, old = (mimoc.InfantEnv(found(age, 0).bundle) for age in (0, 24))
    assert young.observation_space == old.observation_space
    assert young.action_space == old.action_space


def test_delayed_signals_stay_on_their_way(live):
    """With a delay of its own, an infant observes after growth what it sensed before it."""
    env = live(6, delays={"sensory_ms": 100, "motor_ms": 50})
    twin = copy.deepcopy(env)
    env.grow(to=6.5)
    still = np.zeros(env.model.nu, np.float32)
    for _ in range(9):
        assert np.array_equal(env.step(still)[0]["proprioception"], twin.step(still)[0]["proprioception"])


@pytest.mark.parametrize(
    "noise", [{}, {"delay_jitter_ms": 10, "motor": 0.1, "proprioception_deg": 1.0}], ids=["plain", "noisy"]
)
def test_delays_of_an_age_come_with_it(live, noise):
    env = live(0, delays={"preset": "physiological"}, noise=noise)
    for age_months in (24, 3, 12, 0):
        env.grow(to=age_months)
        assert all(observation in env.observation_space for observation in flail(env, 30, seed=int(age_months)))
    assert env.manifest.delays == mimoc.build(spec(0, delays={"preset": "physiological"})).manifest.delays


def test_an_expression_is_kept(live):
    env = live(6)
    env.set_expression("happy")
    env.grow(to=7)
    material = env.model.skin_matid[env.model.skin("head").id]
    assert env.model.material(material).name == env.manifest.face.materials["happy"]


def test_acuity_is_that_of_the_new_age(live):
    senses = {"vision": {"width_px": 24, "height_px": 24}}
    env = live(1, senses=senses, scene={"kind": "room", "pose": "sitting"}, steps=1)
    env.grow(to=20)
    env.reset(seed=0)
    other = live(20, senses=senses, scene={"kind": "room", "pose": "sitting"}, steps=0)
    seen, expected = env.reset(seed=0)[0], other.reset(seed=0)[0]
    assert all(np.array_equal(seen[eye], expected[eye]) for eye in expected)


def test_points_of_the_skin_stay_the_same_points(live):
    env = live(3, senses={"touch": {"density": 0.2}})
    before = env.skin
    env.grow(to=18)
    assert np.array_equal(env.skin.bodies, before.bodies)
    assert env.skin.positions.shape == before.positions.shape


@pytest.mark.parametrize("kind", ["reach", "catch", "selfbody", "rollover", "standup"])
def test_a_task_goes_on(live, kind):
    pose = {} if kind in ("catch", "standup", "reach") else {"scene": {"pose": "supine"}}
    env = live(9, task={"kind": kind}, steps=3, **pose)
    before = copy.deepcopy(env.task.state)
    env.grow(to=9.5)
    assert env.task.state.keys() == before.keys()
    assert all(np.array_equal(env.task.state[name], before[name]) for name in before)
    env.step(np.zeros(env.action_space.shape, np.float32))
    assert simulation_warnings(env.data) == ()


def test_a_ball_stays_as_large_and_as_heavy_as_it_is(live):
    env = live(9, task={"kind": "catch"}, steps=1)
    ball = env.model.geom("ball")
    size, mass = ball.size.copy(), env.model.body("target").mass.copy()
    env.grow(to=12)
    assert np.array_equal(env.model.geom("ball").size, size)
    assert np.array_equal(env.model.body("target").mass, mass)
    assert env.model.body_subtreemass[0] == pytest.approx(env.model.body_mass.sum())


def test_what_is_held_stays_held(live):
    """A hip that is held moves with the lift, and no constraint pulls at it."""
    env = live(6, scene={"held": ["hip"], "pose": "sitting"}, actuation={"locked": ["neck"]})
    env.grow(to=12)
    assert deepest_m(env) < DEEPEST_M
    place = env.data.body("hip").xpos.copy()
    flail(env, 30)
    assert env.data.body("hip").xpos == pytest.approx(place, abs=2e-3)


POSES = ("supine", "prone", "sitting", "standing")


def energy_j(env: mimoc.InfantEnv) -> float:
    mujoco.mj_energyPos(env.model, env.data)
    mujoco.mj_energyVel(env.model, env.data)
    return float(env.data.energy.sum())


@pytest.mark.full
@pytest.mark.parametrize("pose", POSES)
def test_infants_grow_in_quarter_months_without_sinking_into_anything(live, pose):
    env = live(5, scene={"pose": pose})
    for stage in range(1, 9):
        env.grow(to=5 + stage / 4)
        assert deepest_m(env) < DEEPEST_M
        assert np.isfinite(energy_j(env))
        flail(env, 5, seed=stage)
    assert simulation_warnings(env.data) == ()


@pytest.mark.parametrize("pose", POSES)
@pytest.mark.parametrize(("young", "old"), [(0, 24), (24, 0)])
def test_infants_grow_in_one_jump_without_sinking_into_anything(live, pose, young, old):
    env = live(young, scene={"pose": pose})
    env.grow(to=old)
    assert deepest_m(env) < DEEPEST_M
    before_j = energy_j(env)
    for observation in flail(env, 20):
        assert observation in env.observation_space
    assert energy_j(env) < before_j + 30
    assert simulation_warnings(env.data) == ()


@pytest.mark.parametrize(
    "keys", [{"kind": "room", "toys": {"count": [4, 4]}}, {"kind": "crib", "toys": {"count": [3, 3]}}]
)
def test_infants_among_toys_grow_without_sinking_into_them(live, keys):
    env = live(6, scene={**keys, "pose": "sitting"})
    toys = [env.data.joint(toy.joint).qpos.copy() for toy in env.manifest.toys]
    env.grow(to=9)
    assert deepest_m(env) < DEEPEST_M
    for before, toy in zip(toys, env.manifest.toys, strict=True):
        assert env.data.joint(toy.joint).qpos[:3] == pytest.approx(before[:3], abs=0.05)


@pytest.mark.parametrize(("pose", "seed"), [("prone", 3), ("supine", 1)])
def test_toys_are_not_pushed_into_the_floor(live, pose, seed):
    """Limbs come to lie on toys that they were beside."""
    env = live(0, scene={"kind": "room", "toys": {"count": [4, 4]}, "seed": seed, "pose": pose})
    env.grow(to=3)
    assert deepest_m(env) < DEEPEST_M
    assert max(-contact.dist for contact in env.data.contact) < DEEPEST_M


def test_a_crib_grows_along(live):
    """It has more bars at 24 months than at 12, and the infant goes on all the same."""
    env = live(12, scene={"kind": "crib", "toys": {"count": [2, 2]}})
    bars, twin = env.model.ngeom, copy.deepcopy(env)
    env.grow(to=24)
    assert env.model.ngeom > bars
    assert deepest_m(env) < DEEPEST_M
    env.set_state(twin.get_state())
    assert same(flail(env, 5), flail(twin, 5))
