"""Arousal: a spec or an episode has more or less muscle tone, with motors and with muscles."""

import copy

import numpy as np
import pytest

import mimoc
from mimoc.bundle.model import load_model


def spec_of(model="torque", arousal=1.0, development="maturing", age_months=0.0):
    actuation = {"model": model, "arousal": arousal}
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "development": development, "actuation": actuation}
    return mimoc.InfantSpec.model_validate({**data, "scene": {"kind": "flat", "pose": "supine"}})


def tone(model):
    """Return all that tone changes."""
    return np.concatenate([model.actuator_biasprm[:, :3].ravel(), model.jnt_stiffness, model.qpos_spring])


@pytest.fixture(params=["torque", "muscle", "position"])
def env(request):
    return mimoc.make(spec_of(request.param)).unwrapped


@pytest.mark.parametrize("arousal", [0.0, 0.5, 1.5])
def test_an_episode_has_the_tone_of_a_spec_of_the_same_arousal(env, arousal):
    env.reset(options={"arousal": arousal})
    written = load_model(mimoc.build(spec_of(env.manifest.actuation.model, arousal)))
    assert tone(env.model) == pytest.approx(tone(written), rel=1e-6, abs=1e-8)
    env.reset()
    assert np.array_equal(tone(env.model), tone(load_model(env.bundle)))


@pytest.mark.parametrize("env", ["torque", "muscle"], indirect=True)
def test_slack_newborns_straighten_their_hips_and_quiet_ones_rest_bent(env):
    hip_deg = {}
    for arousal in (0.0, 1.0):
        env.reset(seed=0, options={"arousal": arousal})
        for _ in range(300):
            env.step(np.zeros(env.action_space.shape))
        hip_deg[arousal] = np.degrees(env.data.joint("robot:left_hip1").qpos[0])
    assert hip_deg[0.0] > -40
    assert -65 < hip_deg[1.0] < -45


@pytest.mark.parametrize("env", ["torque", "muscle"], indirect=True)
def test_effort_counts_the_tone_of_motors_and_not_that_of_springs(env):
    efforts = {}
    for arousal in (0.0, 1.0):
        env.reset(seed=0, options={"arousal": arousal})
        for _ in range(100):
            env.step(np.zeros(env.action_space.shape))
        efforts[arousal] = env.effort()
    quiet = 3e-4 if env.manifest.actuation.model == "torque" else 0.0
    assert efforts == {0.0: 0.0, 1.0: pytest.approx(quiet, rel=0.2)}


def test_arousal_is_of_a_state_and_of_a_copy(env):
    env.reset(options={"arousal": 0.0})
    slack, state, other = tone(env.model), env.get_state(), copy.deepcopy(env)
    env.reset()
    assert not np.array_equal(tone(env.model), slack)
    env.set_state(state)
    assert np.array_equal(tone(env.model), slack)
    assert np.array_equal(tone(other.model), slack)


def test_an_infant_that_grows_stays_as_aroused(env):
    env.reset(options={"arousal": 0.5})
    env.grow(to=1.0)
    written = load_model(mimoc.build(spec_of(env.manifest.actuation.model, 0.5, age_months=1.0)))
    assert tone(env.model) == pytest.approx(tone(written), rel=1e-6, abs=1e-8)


def test_an_infant_that_grows_after_a_state_is_as_aroused_as_the_state(env):
    env.set_arousal(0.5)
    state = env.get_state()
    env.reset(options={"age_months": 18.0})
    env.set_state(state)
    env.grow(to=18.0)
    assert env.arousal == 0.5
    written = load_model(mimoc.build(spec_of(env.manifest.actuation.model, 0.5, age_months=18.0)))
    assert tone(env.model) == pytest.approx(tone(written), rel=1e-6, abs=1e-8)


def test_one_arousal_after_another_leaves_nothing_of_the_first(env):
    env.set_arousal(0.3)
    once = tone(env.model)
    for level in (1.7, 0.0, 0.3):
        env.set_arousal(level)
    assert np.array_equal(tone(env.model), once)


def test_a_slack_infant_has_relaxed_joints_and_no_bias():
    motors, muscles = mimoc.make(spec_of()).unwrapped, mimoc.make(spec_of("muscle")).unwrapped
    relaxed = motors.model.jnt_stiffness.copy(), motors.model.qpos_spring.copy()
    motors.set_arousal(0)
    muscles.set_arousal(0)
    assert np.abs(motors.model.actuator_biasprm[:, :3]).max() < 1e-9
    assert muscles.model.jnt_stiffness == pytest.approx(relaxed[0], rel=1e-6, abs=1e-9)
    assert muscles.model.qpos_spring == pytest.approx(relaxed[1], rel=1e-4, abs=1e-6)


@pytest.mark.parametrize("model", ["torque", "muscle"])
def test_infants_of_a_batch_have_an_arousal_each(model):
    envs = mimoc.make_vec(spec_of(model), 3)
    envs.reset(seed=0, options={"arousal": [0.0, None, 1.5]})
    for infant, level in zip(envs.infants, (0.0, 1.0, 1.5), strict=True):
        written = load_model(mimoc.build(spec_of(model, level)))
        assert tone(infant.model) == pytest.approx(tone(written), rel=1e-6, abs=1e-8)
    for later, levels in (([1.0, 0.2, 2.0], (1.0, 0.2, 2.0)), (0.7, (0.7, 0.7, 0.7))):
        envs.set_arousal(later)
        assert envs.get_attr("arousal") == levels
    with pytest.raises(ValueError, match="expected one arousal for all, or 3"):
        envs.set_arousal([1.0, 0.0])
    envs.reset(options={"reset_mask": np.array([False, True, False])})
    assert envs.get_attr("arousal") == (0.7, 1.0, 0.7)


def test_a_recording_is_replayed_with_the_arousal_of_its_time(tmp_path):
    still = np.zeros(44, np.float32)
    with mimoc.Recorder(mimoc.make(spec_of()), tmp_path / "calm") as env:
        for options in ({"arousal": 0.0}, None, {"arousal": 1.5, "age_months": 1.0}):
            env.reset(seed=0, options=options)
            env.step(still)
            env.unwrapped.set_arousal(0.4)
            env.step(still)
    episodes = mimoc.read_recording(tmp_path / "calm")
    assert next(episode.options for episode in episodes) == {"arousal": 0.0}
    assert [changes for episode in episodes for changes in episode.changes.values()] == [[("arousal", 0.4)]] * 3
    assert [again.difference for again in mimoc.replay_recording(tmp_path / "calm")] == [None] * 3


def test_a_state_with_an_impossible_arousal_is_refused(env):
    before = tone(env.model)
    with pytest.raises(ValueError, match="expected an arousal"):
        env.set_state({**env.get_state(), "arousal": 9.0})
    assert np.array_equal(tone(env.model), before)


@pytest.mark.parametrize("arousal", [-0.1, 2.1, float("nan"), "calm", True])
def test_what_is_no_arousal_is_refused(env, arousal):
    for change in (env.set_arousal, lambda level: env.reset(options={"arousal": level})):
        with pytest.raises(ValueError, match="expected an arousal from 0 to 2"):
            change(arousal)


def test_published_infants_have_no_tone():
    env = mimoc.make(spec_of(development="published")).unwrapped
    before = tone(env.model)
    env.reset(options={"arousal": 0.0})
    assert np.array_equal(tone(env.model), before)
