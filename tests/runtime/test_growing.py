"""An infant that grows while it lives goes on where it was, with the body of its new age; states and copies have it."""

import copy
import pickle
from collections.abc import Callable, Iterator
from typing import Any

import gymnasium
import mujoco
import numpy as np
import pytest
from support.growing import DEEPEST_M, SENSES, deepest_m, spec
from support.running import flail
from support.same import same

import mimoc
from mimoc.base.errors import BundleError, MimocError, UnknownNameError
from mimoc.bundle.model import load_model, simulation_warnings
from mimoc.compiler.variants import SpecVariants
from mimoc.runtime.growth_wrapper import read_ages


@pytest.fixture(scope="module")
def variants() -> Callable[..., SpecVariants]:
    """Return what builds the infants of a spec, each once."""
    found: dict[str, SpecVariants] = {}

    def of(age_months: float = 6, **keys: Any) -> SpecVariants:
        wanted = spec(age_months, **keys)
        told = wanted.model_dump_json(exclude_unset=True)
        return found.setdefault(told, found.get(told) or SpecVariants(wanted))

    return of


@pytest.fixture
def live(variants) -> Iterator[Callable[..., mimoc.InfantEnv]]:
    """Return what opens the environment of a spec given as keywords, and lets the infant flail a little."""
    opened: list[mimoc.InfantEnv] = []

    def open_one(age_months: float = 6, steps: int = 20, **keys: Any) -> mimoc.InfantEnv:
        found = variants(age_months, **keys)
        env = mimoc.InfantEnv(found.original, variants=found)
        opened.append(env)
        env.reset(seed=0)
        flail(env, steps)
        return env

    yield open_one
    for env in opened:
        env.close()


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


# Chance, states and copies.


def test_growth_draws_no_random_numbers(live):
    env = live(6, noise={"motor": 0.1})
    before = env.get_state()
    env.grow(to=8)
    after = env.get_state()
    assert after["random"] == before["random"]
    assert after["noise"] == before["noise"]


def test_a_state_brings_its_age_along(live):
    env = live(6, delays={"preset": "physiological"})
    env.grow(to=9.5)
    flail(env, 5)
    state = pickle.loads(pickle.dumps(env.get_state()))
    expected = flail(env, 10)
    env.grow(to=3)
    env.set_state(state)
    assert env.age_months == 9.5
    assert same(flail(env, 10), expected)


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda env: pickle.loads(pickle.dumps(env))], ids=["copy", "pickle"])
def test_copies_have_the_age_and_go_on_growing(live, copied):
    env = live(6, task={"kind": "catch"}, steps=3)
    env.grow(to=9)
    twin = copied(env)
    assert twin.age_months == 9
    assert same(flail(twin, 5), flail(env, 5))
    for each in (twin, env):
        each.grow(to=10)
    assert same(flail(twin, 5), flail(env, 5))


def test_an_episode_can_start_at_another_age_pose_and_scene(live):
    env = live(6, scene={"kind": "room", "toys": {"count": [2, 2]}})
    _, info = env.reset(seed=3, options={"age_months": 12.5, "pose": "standing", "scene_seed": 7})
    assert (info["age_months"], env.manifest.seed) == (12.5, 7)
    assert np.array_equal(env.data.qpos, env.model.key("standing").qpos)
    other = live(12.5, scene={"kind": "room", "toys": {"count": [2, 2]}, "seed": 7}, steps=0)
    other.reset(seed=3, options={"pose": "standing"})
    assert same(flail(env, 5), flail(other, 5))


def test_growing_to_the_present_age_changes_nothing(live):
    env = live(6)
    model, data = env.model, env.data
    env.grow(to=6)
    assert env.model is model
    assert env.data is data


# Ways to an environment that grows.


@pytest.mark.full
def test_bundles_specs_and_tasks_can_grow(tmp_path):
    bundle = mimoc.build(spec(6))
    folder = mimoc.write_bundle(bundle, tmp_path / "out")
    made = [
        mimoc.make(spec(6)),
        mimoc.make(bundle),
        mimoc.make(folder),
        gymnasium.make("mimoc/Infant-v0", bundle=folder),
        gymnasium.make("mimoc/Reach-v0", age_months=6),
    ]
    for env in made:
        env.reset(seed=0)
        env.unwrapped.grow(to=6.5)
        assert env.step(env.action_space.sample())[4]["age_months"] == 6.5


def test_an_individual_keeps_its_percentiles():
    """Measured at six months, it is as tall and as heavy among children of its sex at a year."""
    body = {"individual": {"sex": "female", "length_cm": 64.0, "weight_kg": 6.6}}
    env = mimoc.make(spec(6, body=body)).unwrapped
    who = mimoc.build(spec(6, body={"individual": {"sex": "female", "length_percentile": 50}})).manifest.child
    assert isinstance(env, mimoc.InfantEnv)
    shorter_cm = who.length_cm - env.manifest.child.length_cm
    env.grow(to=12)
    average = mimoc.build(spec(12, body={"individual": {"sex": "female", "length_percentile": 50}})).manifest.child
    assert env.manifest.child.length_cm > 68
    assert average.length_cm - env.manifest.child.length_cm == pytest.approx(shorter_cm, rel=0.35)


# Bad input.


@pytest.mark.parametrize("age_months", [-0.1, 24.1, float("nan"), float("inf"), "nine", None, True, [9]])
def test_what_is_no_age_is_refused_and_changes_nothing(live, age_months):
    env = live(6)
    before = env.get_state()["physics"]
    for ask in (lambda: env.grow(to=age_months), lambda: env.reset(options={"age_months": age_months})):
        with pytest.raises(ValueError, match="expected an age from 0 to 24 months"):
            ask()
    assert np.array_equal(env.get_state()["physics"], before)
    assert env.age_months == 6


def test_a_child_that_was_born_early_has_no_age_before_its_term(live):
    env = live(6, impairments={"gestation_weeks": 30})
    many = mimoc.make_vec(env.bundle, 2)
    for ask in (
        lambda: env.grow(to=1),
        lambda: env.reset(options={"age_months": 1}),
        lambda: many.grow(to=1),
        lambda: many.reset(options={"age_months": 1}),
    ):
        with pytest.raises(
            MimocError, match=r"age_months: at 1 months: a child .* is not at term yet, .* 2\.3 or more$"
        ):
            ask()
    many.close()
    assert env.age_months == 6


def test_a_contracture_whose_joint_has_less_range_at_another_age_grows_along(live):
    env = live(9, impairments={"range": {"left_elbow": [-10, -1]}})
    env.grow(to=4)
    assert env.age_months == 4


def test_an_environment_without_variants_says_what_to_do():
    env = mimoc.InfantEnv(mimoc.build(spec(6)))
    with pytest.raises(MimocError, match=r"open it with mimoc\.make"):
        env.grow(to=7)
    with pytest.raises(UnknownNameError, match="age_months"):
        env.reset(options={"age_months": 7})


def test_a_bundle_that_cannot_be_built_again_says_so():
    bundle = mimoc.build(spec(6))
    files = {name: content for name, content in bundle.files.items() if name != "resolved.yaml"}
    env = mimoc.make(mimoc.Bundle(files, bundle.manifest, None))
    env.reset(seed=0)
    with pytest.raises(BundleError, match=r"cannot be built at 7 months: there is no resolved\.yaml"):
        env.unwrapped.grow(to=7)
    env.step(env.action_space.sample())


def test_a_pose_that_does_not_exist_leaves_the_age_as_it_is(live):
    env = live(6)
    with pytest.raises(UnknownNameError, match="kneeling"):
        env.reset(options={"age_months": 9, "pose": "kneeling"})
    assert env.age_months == 6


def test_an_observation_that_changes_its_space_is_refused_and_changes_nothing(variants):
    class Size:
        """A sense whose bounds change with the body."""

        def bind(self, model, bundle):
            self.space = gymnasium.spaces.Box(0.0, float(model.body_mass.sum()), (1,))

        def __call__(self, data):
            return [0.0]

    found = variants(6)
    env = mimoc.InfantEnv(found.original, variants=found, senses={"size": Size()})
    env.reset(seed=0)
    flail(env, 3)
    twin = mimoc.InfantEnv(found.original, senses={"size": Size()})
    twin.set_state(env.get_state())
    with pytest.raises(MimocError, match="the space of the observation 'size' changes"):
        env.grow(to=9)
    assert env.age_months == 6
    assert same(flail(env, 3), flail(twin, 3))


def test_a_state_of_another_age_needs_an_environment_that_grows(live):
    env = live(6)
    state = env.get_state()
    other = mimoc.InfantEnv(mimoc.build(spec(7)))
    with pytest.raises(ValueError, match="state has age_months 6, but this environment has 7"):
        other.set_state(state)


SPEC = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"proprioception": {}}}


def ages(schedule, steps):
    return [schedule(step) for step in range(steps)]


def test_growth_goes_from_the_youngest_age_to_the_oldest_and_stays_there():
    found = ages(mimoc.growth_schedule("grown", (6, 7), steps=100), 120)
    assert sorted(set(found)) == [6, 6.25, 6.5, 6.75, 7]
    assert found == sorted(found)
    assert found[:20] == [6] * 20
    assert found[99:] == [7] * 21


def test_an_adult_has_the_oldest_age_throughout():
    assert set(ages(mimoc.growth_schedule("adult", (6, 7), steps=100), 100)) == {7}


def test_all_other_courses_have_the_same_ages_for_as_long():
    grown, back, mixed, other = (
        ages(mimoc.growth_schedule(course, (0, 24), steps=970, seed=seed), 970)
        for course, seed in (("grown", 0), ("reversed", 0), ("shuffled", 0), ("shuffled", 1))
    )
    assert back == grown[::-1]
    assert sorted(mixed) == sorted(other) == grown
    assert mixed != other
    assert mixed == ages(mimoc.growth_schedule("shuffled", (0, 24), 970, seed=np.random.default_rng(0)), 970)


@pytest.mark.parametrize(("text", "expected"), [("6:12", (6, 12)), ("0:0.5", (0, 0.5))])
def test_a_range_of_ages_is_read(text, expected):
    assert read_ages(text) == expected


@pytest.mark.parametrize("text", ["6", "6-12", "12:6", "6:25", "-1:3", "six:12", "6:6", "6:nan", ""])
def test_what_is_no_range_of_ages_is_refused(text):
    with pytest.raises(MimocError, match="range of ages"):
        read_ages(text)


def test_unknown_courses_and_impossible_numbers_are_refused():
    with pytest.raises(UnknownNameError, match="did you mean 'grown'"):
        mimoc.growth_schedule("grwn", (6, 12), steps=10)
    with pytest.raises(MimocError, match="at least one control step"):
        mimoc.growth_schedule("grown", (6, 12), steps=0)
    with pytest.raises(MimocError, match="positive number of months"):
        mimoc.growth_schedule("grown", (6, 12), steps=10, stage_months=0)


def test_an_environment_grows_with_its_steps():
    env = mimoc.GrowthWrapper(mimoc.make(mimoc.InfantSpec.model_validate(SPEC)), "grown", ages_months=(9, 9.5), steps=6)
    space = env.observation_space
    told = [env.reset(seed=0)[1]["age_months"]]
    for _ in range(4):
        observation, *_, info = env.step(env.action_space.sample())
        told.append(info["age_months"])
        assert observation in space
    told.append(env.reset()[1]["age_months"])
    told += [env.step(env.action_space.sample())[4]["age_months"] for _ in range(3)]
    assert told == [9, 9, 9, 9.25, 9.25, 9.5, 9.5, 9.5, 9.5]
    assert env.reset(options={"age_months": 3})[1]["age_months"] == 3
    env.close()


def test_only_infants_grow():
    with pytest.raises(MimocError, match=r"mimoc\.make"):
        mimoc.GrowthWrapper(gymnasium.make("CartPole-v1"), lambda step: 6.0)
