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


@pytest.fixture(params=["torque", "muscle"])
def env(request):
    return mimoc.make(spec_of(request.param)).unwrapped


@pytest.mark.parametrize("arousal", [0.0, 0.5, 1.5])
def test_an_episode_has_the_tone_of_a_spec_of_the_same_arousal(env, arousal):
    env.reset(options={"arousal": arousal})
    written = load_model(mimoc.build(spec_of(env.manifest.actuation.model, arousal)))
    assert tone(env.model) == pytest.approx(tone(written), rel=1e-6, abs=1e-8)
    env.reset()
    assert np.array_equal(tone(env.model), tone(load_model(env.bundle)))


def test_slack_newborns_straighten_their_hips_and_quiet_ones_rest_bent(env):
    hip_deg = {}
    for arousal in (0.0, 1.0):
        env.reset(seed=0, options={"arousal": arousal})
        for _ in range(300):
            env.step(np.zeros(env.action_space.shape))
        hip_deg[arousal] = np.degrees(env.data.joint("robot:left_hip1").qpos[0])
    assert hip_deg[0.0] > -40
    assert -65 < hip_deg[1.0] < -45


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


@pytest.mark.parametrize("arousal", [-0.1, 2.1, float("nan"), "calm", True])
def test_what_is_no_arousal_is_refused(env, arousal):
    with pytest.raises(ValueError, match="expected an arousal from 0 to 2"):
        env.reset(options={"arousal": arousal})


def test_published_infants_and_servos_have_no_tone():
    for spec in (spec_of(development="published"), spec_of("position")):
        env = mimoc.make(spec).unwrapped
        before = tone(env.model)
        env.reset(options={"arousal": 0.0})
        assert np.array_equal(tone(env.model), before)
