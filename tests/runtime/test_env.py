from itertools import pairwise

import gymnasium
import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from support.running import actions
from support.same import same

import mimoc
from mimoc.base.errors import BundleError, UnknownNameError


def rollout(env, commands, seed=0):
    """Return the observations of a reset and some steps, as one array for each sense."""
    seen = [env.reset(seed=seed)[0], *(env.step(command)[0] for command in commands)]
    return {sense: np.array([observation[sense] for observation in seen]) for sense in seen[0]}


# Gymnasium.


@pytest.mark.matrix
def test_every_config_passes_gymnasiums_checker_without_a_warning(config):
    check_env(mimoc.make(config).unwrapped)


@pytest.mark.parametrize("scene", ["empty", "flat", "crib", "room"])
def test_gymnasiums_checker_finds_nothing_in_the_pictures_of_any_scene_either(built, scene):
    check_env(mimoc.make(built(scene={"kind": scene}), render_mode="rgb_array").unwrapped)


def test_a_bundle_in_memory_and_its_folder_make_the_same_environment(bundle, tmp_path):
    folder = mimoc.write_bundle(bundle, tmp_path / "out")
    made = [
        mimoc.make(bundle),
        mimoc.make(folder),
        mimoc.make(str(folder)),
        gymnasium.make("mimoc/Infant-v0", bundle=folder),
        mimoc.InfantEnv(folder),
    ]
    runs = [rollout(env, actions(made[0], 5)) for env in made]
    assert all(same(run, runs[0]) for run in runs)


@pytest.mark.parametrize("mode", ["sync", "async"])
def test_many_infants_run_as_one_vector(bundle, mode):
    alone = rollout(mimoc.make(bundle), actions(mimoc.make(bundle), 5))
    infants = gymnasium.make_vec("mimoc/Infant-v0", num_envs=2, vectorization_mode=mode, bundle=bundle)
    commands = np.repeat(actions(mimoc.make(bundle), 5)[:, None], 2, axis=1)
    together = rollout(infants, commands)
    infants.close()
    assert all(same({sense: seen[:, i] for sense, seen in together.items()}, alone) for i in range(2))


def test_what_is_no_bundle_is_refused(tmp_path):
    with pytest.raises(BundleError):
        mimoc.make(tmp_path / "nowhere")


def test_an_unknown_render_mode_is_refused(bundle):
    with pytest.raises(UnknownNameError, match="'ansi' is not a render mode; choose from human, rgb_array"):
        mimoc.InfantEnv(bundle, render_mode="ansi")


def test_without_a_render_mode_there_is_no_picture(env):
    assert env.render() is None


# Observations.


def test_observations_are_fresh_arrays_within_their_space(env):
    seen = [env.reset(seed=0)[0], *(env.step(command)[0] for command in actions(env, 50))]
    assert all(observation in env.observation_space for observation in seen)
    assert {reading.dtype for observation in seen for reading in observation.values()} == {np.dtype(np.float32)}
    for sense in env.observation_space.spaces:
        readings = [observation[sense] for observation in seen]
        assert not any(np.shares_memory(first, second) for first, second in pairwise(readings))


def test_what_an_agent_does_to_an_observation_changes_nothing(open_env):
    spoiled, left_alone = open_env(), open_env()
    commands = actions(spoiled, 5)
    spoiled.reset(seed=0)[0]["proprioception"][:] = np.nan
    for command in commands[:-1]:
        for reading in spoiled.step(command)[0].values():
            reading[:] = np.nan
    last = spoiled.step(commands[-1])[0]
    assert same(last, {sense: seen[-1] for sense, seen in rollout(left_alone, commands).items()})


def test_the_layout_names_every_number_of_an_observation(env):
    for sense, space in env.observation_space.spaces.items():
        names = env.layout(sense)
        assert len(names) == len(set(names)) == space.shape[0]
        assert all(name.endswith("]") and " [" in name for name in names)


def test_the_layout_of_a_sense_that_is_off_is_refused(open_env):
    env = open_env(senses={"vestibular": {}})
    with pytest.raises(UnknownNameError, match="'proprioception' is not a sense of this infant"):
        env.layout("proprioception")


@pytest.mark.parametrize("senses", [["proprioception"], ["vestibular"], ["proprioception", "vestibular"]])
def test_a_sense_that_is_not_named_is_off(open_env, senses):
    env = open_env(senses={sense: {} for sense in senses})
    assert list(env.observation_space) == senses
    assert list(env.reset(seed=0)[0]) == list(env.step(env.action_space.low)[0]) == senses


# Time and chance.


def test_a_step_lasts_as_long_as_the_spec_says(open_env):
    for step_ms, timestep_ms in [(10, 5), (20, 2.5), (5, 5)]:
        env = open_env(control={"step_ms": step_ms, "timestep_ms": timestep_ms})
        env.reset(seed=0)
        for command in actions(env, 3):
            env.step(command)
        assert env.data.time == pytest.approx(3 * step_ms / 1000)
        assert env.model.opt.timestep == pytest.approx(timestep_ms / 1000)


@pytest.mark.matrix
def test_the_same_seed_and_actions_give_the_same_numbers(open_env):
    first, second = open_env(), open_env()
    commands = actions(first, 100)
    assert same(rollout(first, commands), rollout(second, commands))


def test_two_infants_side_by_side_do_not_influence_each_other(open_env):
    one, other = open_env(), open_env()
    alone = rollout(one, actions(one, 30, seed=1))
    one.reset(seed=0)
    other.reset(seed=0, options={"pose": "prone"})
    for step, (mine, theirs) in enumerate(zip(actions(one, 30, seed=1), actions(other, 30, seed=2), strict=True)):
        observation = one.step(mine)[0]
        other.step(theirs)
        assert same(observation, {sense: seen[step + 1] for sense, seen in alone.items()})


def test_a_reset_forgets_everything(open_env):
    env, new = open_env(), open_env()
    rollout(env, actions(env, 100, seed=3))
    commands = actions(env, 20)
    assert same(rollout(env, commands), rollout(new, commands))


def test_a_reset_starts_from_the_pose_that_is_asked_for(env):
    for pose in env.manifest.poses:
        env.step(env.action_space.high)
        env.reset(options={"pose": pose})
        assert np.array_equal(env.data.qpos, env.model.key(pose).qpos)
        assert not env.data.qvel.any()


def test_a_reset_starts_from_the_pose_of_the_spec_otherwise(env):
    start = env.data.qpos.copy()
    assert np.array_equal(start, env.model.key("sitting").qpos)
    env.reset(options={"pose": "prone"})
    for options in (None, {}):
        env.reset(options=options)
        assert np.array_equal(env.data.qpos, start)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"pose": "sittin"}, r"'sittin' is not a pose; did you mean 'sitting'\?"),
        ({"pose": 3}, "'3' is not a pose; choose from prone, sitting, standing, supine"),
        ({"seed": 3}, "'seed' is not a reset option; choose from arousal, pose"),
    ],
)
def test_bad_reset_options_are_refused_and_change_nothing(env, options, message):
    commands = actions(env, 2)
    env.step(commands[0])
    before = env.data.qpos.copy()
    with pytest.raises(UnknownNameError, match=message):
        env.reset(options=options)
    assert np.array_equal(env.data.qpos, before)
    env.step(commands[1])


# Where things go wrong.


def test_an_action_beyond_its_range_counts_as_its_limit(open_env):
    beyond, within = open_env(), open_env()
    commands = 5 * actions(beyond, 20)
    commands[3, 2], commands[4, 5] = 1e30, -1e30
    assert same(rollout(beyond, commands), rollout(within, np.clip(commands, -1, 1)))


NOT_FINITE = (np.nan, np.inf, -np.inf)


def last(value):
    """Return an action that is wrong in its last command only."""
    return np.append(np.zeros(43), value)


@pytest.mark.parametrize("wrong", [0.0, np.zeros(1), np.zeros(45), np.zeros((44, 1)), *map(last, NOT_FINITE)])
def test_what_is_no_action_is_refused_and_changes_nothing(env, wrong):
    before = env.data.ctrl.copy()
    with pytest.raises(ValueError, match=r"expected a finite action of shape \(44,\), got"):
        env.step(wrong)
    assert np.array_equal(env.data.ctrl, before)
    assert env.data.time == 0


@pytest.mark.matrix
@pytest.mark.parametrize("value", [np.nan, np.inf, -1e20])
@pytest.mark.parametrize("state", ["qpos", "qvel"])
def test_a_simulation_that_breaks_down_ends_the_episode_quietly(open_env, state, value, capfd, tmp_path, monkeypatch):
    """MuJoCo itself starts it anew within the step, prints a warning and writes it to a file."""
    monkeypatch.chdir(tmp_path)
    env, new = open_env(), open_env()
    env.reset(seed=0)
    commands = actions(env, 10)
    getattr(env.data, state)[20] = value
    observation, reward, terminated, truncated, info = env.step(commands[0])
    assert (terminated, truncated) == (True, False)
    assert info == {"is_success": False, "reward_terms": {}, "unstable": True, "age_months": 9}
    assert np.isfinite(reward)
    assert observation in env.observation_space
    assert same(rollout(env, commands), rollout(new, commands))
    calm = {"is_success": False, "reward_terms": {}, "unstable": False, "age_months": 9}
    assert env.step(commands[0])[2:] == (False, False, calm)
    assert capfd.readouterr() == ("", "")
    assert not list(tmp_path.iterdir())


def test_what_is_no_number_is_felt_as_zero(env):
    """It stays in the simulation where MuJoCo is told not to start anew by itself."""
    env.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    env.data.qvel[:] = np.nan
    observation, _, terminated, _, _ = env.step(env.action_space.high)
    assert terminated
    assert observation in env.observation_space
    assert not observation["vestibular"].any()


def test_an_infant_without_senses_observes_a_zero():
    """Gymnasium allows no empty observation, and a spec need not name any sense."""
    env = mimoc.make(mimoc.build(mimoc.InfantSpec(mimoc=1, name="senseless", age_months=3)))
    check_env(env.unwrapped)
    observation, _ = env.reset(seed=0)
    assert observation == {"nothing": 0.0}
