"""Several infants in one world: each lives as it does alone, and they touch and see each other."""

import mujoco
import numpy as np
import pytest
from gymnasium.error import ClosedEnvironmentError
from pettingzoo.test import parallel_api_test, parallel_seed_test
from support.store import built
from support.worlds import ANNA, BEN, placed, world

import mimoc
from mimoc.base.errors import KindError, MimocError, UnknownNameError
from mimoc.bundle.world import WorldBundle
from mimoc.policies.many import policy_vec
from mimoc.policies.policy_file import interface_of
from mimoc.policies.rollout import Run, rollout
from mimoc.runtime.opening import open_infant
from mimoc.runtime.world_env import WorldEnv

FAR = 1e-9
"""What may differ between an infant that is alone and one whose neighbour is far away, over some control steps."""
LATE = {
    **BEN,
    "delays": {"sensory_ms": 30, "motor_ms": 20, "proprioception_ms": 10},
    "noise": {"motor": 0.1, "proprioception_deg": 0.5, "delay_jitter_ms": 10},
}
SOME_MS = 60.0
KINDS = {
    "delayed and noisy": LATE,
    "a servo": {**ANNA, "actuation": {"model": "position"}},
    "muscles": {**ANNA, "actuation": {"model": "muscle"}},
    "published": {**ANNA, "development": "published"},
    "reaching": {**ANNA, "task": {"kind": "reach"}},
    "sitting": {**ANNA, "task": {"kind": "sit"}, "scene": {"pose": "sitting"}},
    "touching itself": {**ANNA, "task": {"kind": "selfbody"}},
}


@pytest.fixture(scope="module")
def pair() -> WorldBundle:
    return world(anna=ANNA, ben=BEN)


@pytest.fixture
def env(pair):
    with_pettingzoo = mimoc.make_parallel(pair)
    yield with_pettingzoo
    with_pettingzoo.close()


def sampled(env, seed: int = 0) -> dict[str, np.ndarray]:
    """Return an action of each agent."""
    generator = np.random.default_rng(seed)
    spaces = {name: env.action_space(name) for name in env.agents}
    return {name: generator.uniform(space.low, space.high).astype(np.float32) for name, space in spaces.items()}


def assert_alike(ours, theirs, tolerance: float = 0.0):
    assert ours.keys() == theirs.keys()
    for name in ours:
        assert np.allclose(ours[name], theirs[name], rtol=tolerance, atol=tolerance), name


def test_it_is_what_pettingzoo_expects(env, pair):
    parallel_api_test(env, num_cycles=30)
    parallel_seed_test(lambda: mimoc.make_parallel(pair), num_cycles=10)


def test_agents_are_infants_with_the_spaces_that_they_have_alone(env):
    assert env.possible_agents == ["anna", "ben"]
    for name, data in {"anna": ANNA, "ben": BEN}.items():
        alone = open_infant(built(data))
        assert env.observation_space(name) == alone.observation_space
        assert env.action_space(name) == alone.action_space
        assert {sense: env.infants[name].layout(sense) for sense in alone.senses} == {
            sense: alone.layout(sense) for sense in alone.senses
        }
    _, infos = env.reset(seed=0)
    assert (infos["anna"]["age_months"], infos["ben"]["age_months"]) == (9.0, 3.0)


@pytest.mark.parametrize("kind", KINDS)
def test_an_infant_alone_in_a_world_lives_as_in_its_own_environment(kind):
    data = KINDS[kind]
    alone, shared = open_infant(built(data)), WorldEnv(world(kim=data))
    assert_lives_alike(alone, shared, "kim", 1e-6)


@pytest.mark.parametrize("kind", KINDS)
def test_an_infant_lives_as_alone_while_another_moves_five_metres_away(kind):
    data = KINDS[kind]
    far = placed({"anna": data, "ben": data}, {"y_cm": 0}, {"y_cm": 500})
    assert_lives_alike(open_infant(built(data)), WorldEnv(far), "anna", 1e-6)


def assert_lives_alike(alone, shared: WorldEnv, name: str, tolerance: float):
    """Assert that an infant senses and earns in its world what it does alone, with the same seed and the same actions.

    Observations are in single precision; what MuJoCo computes is compared more closely. Contacts make small differences
    grow, so it is only for some control steps.
    """
    ours, _ = alone.reset(seed=7)
    theirs, _ = shared.reset(seed=7)
    prefix = shared.infants[name].manifest.prefix
    for step in range(round(SOME_MS / alone.manifest.step_ms)):
        assert_alike(ours, theirs[name], tolerance)
        actions = sampled(shared, step)
        ours, reward, terminated, truncated, info = alone.step(actions[name])
        theirs, rewards, ended, cut, infos = shared.step(actions)
        assert rewards[name] == pytest.approx(reward, abs=tolerance)
        assert (ended[name], cut[name]) == (terminated, truncated)
        assert infos[name].keys() == info.keys()
        if terminated:
            return
    for joint in range(1, alone.model.njnt):
        one = alone.data.joint(joint)
        if alone.manifest.root_body == "hip" and one.name.startswith("robot:"):
            assert np.allclose(one.qpos, shared.data.joint(prefix + one.name).qpos, rtol=0, atol=FAR)


def test_two_infants_touch_and_feel_the_same_force_in_opposite_directions():
    bundle = world({"kind": "empty"}, anna=ANNA, ben=BEN)
    shared = WorldEnv(bundle)
    shared.reset(seed=0)
    towards = shared.data.body("ben_hip").xpos - shared.data.body("anna_hip").xpos
    shared.data.joint("anna_mimo_location").qvel[:3] = 1.5 * towards / np.linalg.norm(towards)
    felt = []
    for step in range(60):
        shared.step({name: 0.3 * action for name, action in sampled(shared, step).items()})
        mujoco.mj_forward(shared.model, shared.data)
        # Without a floor, what an infant feels of itself adds up to nothing.
        anna, ben = (shared.infants[name].skin.forces.sum(axis=0) for name in ("anna", "ben"))
        assert np.abs(anna + ben).max() <= 1e-9
        felt.append(np.linalg.norm(anna))
    assert max(felt) > 1.0
    assert (anna_touch := shared.infants["anna"].senses["touch"]).bodies is not None
    assert not set(anna_touch.receptors.bodies) & set(shared.infants["ben"].senses["touch"].receptors.bodies)


def test_an_infant_sees_the_other():
    seeing = {"vision": {"width_px": 32, "height_px": 32, "acuity": "off"}}
    sitting = {"mimoc": 1, "name": "one", "age_months": 9, "senses": seeing, "scene": {"pose": "sitting"}}
    seen = {}
    for x_cm in (60, -60):
        places = {"x_cm": 0, "y_cm": 0}, {"x_cm": x_cm, "y_cm": 0, "yaw_deg": 180 if x_cm > 0 else 0}
        shared = WorldEnv(placed({"anna": sitting, "ben": sitting}, *places))
        observations, _ = shared.reset(seed=0)
        seen[x_cm] = observations["anna"]["eye_left"].astype(float)
        shared.close()
    assert np.abs(seen[60] - seen[-60]).mean() > 10.0


def test_pettingzoo_gets_the_physics_of_the_whole_world_as_its_state(env):
    env.reset(seed=1)
    env.step(sampled(env, 0))
    state, data = env.state(), env.data
    assert env.state_space.contains(state)
    assert state.dtype == env.state_space.dtype == np.float32
    assert np.array_equal(state, np.float32(np.concatenate([data.qpos, data.qvel, data.act])))
    env.step(sampled(env, 1))
    assert not np.array_equal(env.state(), state)  # The arrays are the caller's own.


def test_what_is_no_state_of_the_world_changes_nothing(env):
    env.reset(seed=1)
    before = env.get_state()
    for wrong in ({}, {**before, "infants": {}}, {**before, "physics": before["physics"][:-1]}):
        with pytest.raises(ValueError, match="state"):
            env.set_state(wrong)
    assert np.array_equal(env.get_state()["physics"], before["physics"])


def test_a_reset_puts_an_infant_into_another_pose_and_leaves_the_other(env):
    env.reset(seed=0)
    lying = env.data.body("anna_head").xpos[2]
    env.reset(options={"anna": {"pose": "sitting", "arousal": 0.5}})
    assert env.data.body("anna_head").xpos[2] > lying + 0.1
    assert (env.infants["anna"].arousal, env.infants["ben"].arousal) == (0.5, 1.0)
    assert env.data.body("ben_head").xpos[2] < 0.15


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"kim": {"pose": "sitting"}}, "'kim' is not a name of an infant of this world; choose from anna, ben"),
        ({"anna": {"pose": "dancing"}}, "'dancing' is not a pose"),
        ({"anna": {"scene_seed": 3}}, "'scene_seed' is not a reset option of an infant in a world"),
    ],
)
def test_options_that_there_are_not_are_refused(env, options, message):
    with pytest.raises(UnknownNameError, match=message):
        env.reset(options=options)


def test_an_action_of_each_agent_is_needed_and_no_other(env):
    env.reset(seed=0)
    actions = sampled(env)
    with pytest.raises(ValueError, match="expected an action of each of anna, ben; there is none of ben"):
        env.step({"anna": actions["anna"]})
    with pytest.raises(UnknownNameError, match="'kim' is not a name of an infant whose episode goes on"):
        env.step({**actions, "kim": actions["anna"]})
    with pytest.raises(ValueError, match="expected a finite action of shape"):
        env.step({**actions, "ben": actions["anna"][:-1]})


class Short(mimoc.Task):
    """A task that ends after some steps, and pays one for each."""

    def judge(self, data, action, effort):
        return mimoc.Judgement({"step": 1.0})


def test_an_infant_whose_episode_ends_is_no_agent_any_longer_and_stays_where_it_is(pair):
    shared = WorldEnv(pair, tasks={"anna": Short(steps=2), "ben": Short(steps=4)})
    shared.reset(seed=0)
    agents = []
    while shared.agents:
        observations, rewards, _, truncated, _ = shared.step(sampled(shared))
        agents.append(list(shared.agents))
        assert observations.keys() == rewards.keys() == truncated.keys()
        assert set(rewards.values()) == {1.0}
    assert agents == [["anna", "ben"], ["ben"], ["ben"], []]
    assert shared.step({}) == ({}, {}, {}, {}, {})
    observations, _ = shared.reset()
    assert observations.keys() == {"anna", "ben"}


def test_an_unstable_simulation_ends_all_episodes_with_finite_observations(env):
    env.reset(seed=0)
    env.data.qvel[:] = np.nan
    observations, _, terminated, _, infos = env.step(sampled(env))
    assert terminated == {"anna": True, "ben": True}
    assert all(info["unstable"] for info in infos.values())
    assert env.agents == []
    assert all(np.isfinite(array).all() for observation in observations.values() for array in observation.values())


def test_objects_of_a_script_are_for_infants_by_name(pair):
    with pytest.raises(UnknownNameError, match="'kim' is not a name of an infant of this world"):
        WorldEnv(pair, tasks={"kim": Short()})
    with pytest.raises(KindError):
        WorldEnv(pair, tasks={"anna": Short})


def test_keys_of_a_file_can_be_said_of_specs_by_name_as_the_page_prints_it():
    spec = mimoc.InfantSpec(mimoc=1, name="a", age_months=9, senses={})
    made = mimoc.make_parallel({"anna": spec, "ben": spec}, scene={"kind": "crib"}, name="two")
    assert made.bundle.manifest.name == "two"
    assert any(made.model.geom(index).name.startswith("crib") for index in range(made.model.ngeom))
    made.close()


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"task": 1}, UnknownNameError, "'task' is not a keyword of make_parallel; did you mean 'tasks'"),
        ({"max_episode_steps": 5}, UnknownNameError, "'max_episode_steps' is not a keyword of make_parallel"),
        ({"scene": {"kind": "room"}}, MimocError, "scene can be said of specs by name only; this world says so itself"),
        ({"tasks": mimoc.Task()}, KindError, "tasks is .*; pass a dictionary of objects by the name of an infant"),
        ({"senses": {"anna": abs}}, KindError, "senses is .*; pass a dictionary of objects by the name of their"),
        ({"companions": {"anna": abs}}, KindError, "companions is .*; pass a dictionary of objects by name"),
    ],
)
def test_options_of_a_world_that_are_none_are_told_in_one_line(pair, options, kind, message):
    with pytest.raises(kind, match=message):
        mimoc.make_parallel(pair, **options)


def test_a_closed_world_says_so(pair):
    closed = mimoc.make_parallel(pair)
    closed.close()
    closed.close()
    for call in (closed.reset, closed.render, lambda: closed.step({}), closed.infants["anna"].effort):
        with pytest.raises(ClosedEnvironmentError):
            call()
    assert closed.observation_space("anna")


def test_poses_that_would_put_infants_into_each_other_are_refused():
    standing = {**BEN, "scene": {"pose": "standing"}}
    shared = WorldEnv(placed({"anna": standing, "ben": standing}, {"y_cm": 0}, {"y_cm": 30}))
    shared.reset(seed=0)
    with pytest.raises(MimocError, match="'anna' and 'ben' are within each other as they start"):
        shared.reset(options={"anna": {"pose": "supine"}, "ben": {"pose": "supine"}})
    assert shared.agents == []


def test_a_picture_shows_all(pair):
    shared = WorldEnv(pair, render_mode="rgb_array", width=64, height=48)
    shared.reset(seed=0)
    picture = shared.render()
    assert picture.shape == (48, 64, 3)
    assert picture.std() > 5
    shared.close()


def test_a_policy_that_was_trained_alone_fits_an_infant_in_a_world():
    shared = WorldEnv(world(anna=ANNA, ben=BEN))
    assert interface_of(shared.infants["anna"]) == interface_of(open_infant(built(ANNA)))


def test_a_run_is_summed_up_for_each_infant():
    run = Run(WorldEnv(world(anna=ANNA, ben=BEN)), "general_movements", seed=1)
    for _ in range(10):
        run.step()
    summaries = run.summaries()
    assert summaries.keys() == {"anna", "ben"}
    for summary in summaries.values():
        assert (summary.steps, summary.episodes, summary.unstable) == (10, 1, False)
        assert summary.joint_speed_rad_s > 0.05
    assert summaries["anna"].joint_speed_rad_s != summaries["ben"].joint_speed_rad_s


def test_a_policy_that_there_is_not_is_refused():
    with pytest.raises(UnknownNameError, match="'dance' is not a policy"):
        Run(WorldEnv(world(anna=ANNA, ben=BEN)), "dance", seed=0)


def test_policies_of_all_infants_take_the_form_of_their_environment():
    """By name in a world, with a policy for one of them; single ones for one infant; rows in a vector environment."""
    shared, alone = WorldEnv(world(anna=ANNA, ben=BEN)), open_infant(built(ANNA))
    observations, _ = shared.reset(seed=3)
    observation, _ = alone.reset(seed=3)
    act = policy_vec({"anna": "general_movements"}, shared)
    actions = act({name: np.random.default_rng(5) for name in shared.agents}, observations)
    single = policy_vec("general_movements", alone)
    assert (actions["anna"] == single(np.random.default_rng(5), observation)).all()
    assert (actions["ben"] == shared.infants["ben"].rest).all()
    act.reset(["ben"])
    single.reset()
    with pytest.raises(UnknownNameError, match="'kim' is not a name of an infant"):
        policy_vec({"kim": "zero"}, shared)


def test_a_rollout_yields_the_start_of_each_episode_and_its_steps(open_env):
    env = open_env(task={"kind": "reach", "steps": 3})
    steps = list(rollout(env, "random", episodes=2, seed=7))
    assert [(step.episode, step.number, step.ended) for step in steps] == [
        *((0, number, number == 3) for number in range(4)),
        *((1, number, number == 3) for number in range(4)),
    ]
    again = list(rollout(env, "random", episodes=1, seed=8))
    assert [step.reward for step in again] == [step.reward for step in steps[4:]]
    assert len([*rollout(env, "random", seconds=0.05)]) == len([*rollout(env, "random", steps=5)]) == 7
