"""An infant with a voice commands pitch and loudness, and hears what it says, after the delay of its commands."""

import copy
from contextlib import closing
from typing import Any

import numpy as np
import pytest
from support import store
from support.full import full_but

import mimoc
from mimoc.compiler.explain import explain
from mimoc.policies.named import policy_of
from mimoc.runtime.sound import Voice
from mimoc.schema.kinds import POLICIES, TASKS

WAVE = {"hearing": {"output": "waveform", "thresholds": "off"}}


def infant(age_months: float = 3, senses: Any = WAVE, voice: bool = True, **keys) -> mimoc.Bundle:
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "senses": senses, **keys}
    return store.built({**data, "actuation": {"voice": voice, **keys.get("actuation", {})}})


def opened(bundle: mimoc.Bundle) -> mimoc.InfantEnv:
    env = mimoc.make(bundle).unwrapped
    env.reset(seed=0)
    return env


def spoken(env: mimoc.InfantEnv, pitch: float, loudness: float, steps: int) -> np.ndarray:
    """Return what the left ear hears while the infant speaks."""
    action = np.zeros(env.action_space.shape, np.float32)
    action[-2:] = pitch, loudness
    return np.concatenate([env.step(action)[0]["hearing"] for _ in range(steps)], axis=1)[0]


def test_the_action_has_two_more_numbers_only_where_it_is_asked_for():
    with closing(opened(infant())) as env, closing(opened(infant(voice=False))) as mute:
        assert env.action_space.shape[0] == mute.action_space.shape[0] + 2
        assert env.action_space.low[-2:].tolist() == [-1, 0]
        assert env.action_space.high[-2:].tolist() == [1, 1]
        assert (env.actuation.low == mute.actuation.low).all()


@pytest.mark.parametrize("pitch", [-1.0, 0.0, 1.0])
def test_the_voice_has_the_pitch_that_is_commanded(pitch):
    with closing(opened(infant())) as env:
        entry = env.manifest.actuation.voice
        spoken(env, pitch, 1.0, 20)
        sound = spoken(env, pitch, 1.0, 40)
        peak_hz = np.abs(np.fft.rfft(sound * np.hanning(len(sound)), 8 * len(sound))).argmax() * 24_000 / 8 / len(sound)
    assert peak_hz == pytest.approx(entry.low_hz * (entry.high_hz / entry.low_hz) ** ((pitch + 1) / 2), rel=0.01)


def test_an_episode_begins_in_the_same_voice_whatever_was_said_in_the_one_before():
    with closing(opened(infant())) as env:
        first = spoken(env, 1.0, 1.0, 4)
        env.reset(seed=0)
        assert np.array_equal(spoken(env, 1.0, 1.0, 4), first)


def test_half_the_loudness_is_half_the_pressure_and_none_is_silence():
    with closing(opened(infant())) as env:
        rms = {}
        for loudness in (1.0, 0.5, 0.0):
            spoken(env, 0.0, loudness, 60)
            rms[loudness] = np.sqrt(np.mean(spoken(env, 0.0, loudness, 20) ** 2))
    assert rms[0.5] == pytest.approx(rms[1.0] / 2, rel=0.03)
    assert rms[0.0] < 0.01 * rms[1.0]


@pytest.mark.parametrize("delay_ms", [0, 15, 40])
def test_it_hears_itself_after_the_delay_of_its_commands(delay_ms):
    with closing(opened(infant(delays={"motor_ms": delay_ms}))) as env, closing(opened(infant())) as mute:
        sound, other = spoken(env, 0.0, 1.0, 8), spoken(mute, 0.0, 0.0, 8)
    first = np.flatnonzero(np.abs(sound - other) > 1e-4)[0]
    assert 24 * delay_ms <= first <= 24 * (delay_ms + 3)


def test_nothing_clicks_when_pitch_and_loudness_change():
    with closing(opened(infant())) as env:
        spoken(env, 0.0, 0.0, 40)
        chance = np.random.default_rng(0)
        steady = np.abs(np.diff(spoken(env, 1.0, 1.0, 20))).max()
        varied = np.concatenate([spoken(env, *chance.uniform((-1, 0), (1, 1)), 1) for _ in range(60)])
    assert np.abs(np.diff(varied)).max() < 1.2 * steady


@pytest.mark.parametrize(("age_months", "calm_hz"), [(0, 335), (3, 445), (9, 415), (24, 415)])
def test_the_lowest_pitch_is_half_an_octave_below_calm_sounds_of_the_age(age_months, calm_hz):
    bundle = infant(age_months)
    voice = bundle.manifest.actuation.voice
    assert voice.low_hz == pytest.approx(calm_hz / np.sqrt(2))
    assert voice.low_hz < 496 < voice.high_hz
    assert "Kent & Murray" in explain(bundle, "actuation.voice.low_hz").lines[1]


def test_states_and_copies_have_the_voice():
    noise = {"motor": 0.1, "delay_jitter_ms": 5}
    with closing(opened(infant(delays={"motor_ms": 20}, noise=noise))) as env:
        spoken(env, 1.0, 0.5, 6)
        other, state = copy.deepcopy(env), env.get_state()
        wanted = spoken(env, 0.5, 1.0, 6)
        assert wanted.any()
        assert (spoken(other, 0.5, 1.0, 6) == wanted).all()
        env.set_state(state)
        assert (spoken(env, 0.5, 1.0, 6) == wanted).all()


@pytest.mark.parametrize(
    "policy", full_but(["random", "kick+reflexes"], ["zero", "general_movements", "random+zero", "sit"])
)
def test_policies_that_know_of_no_voice_are_silent(policy):
    senses = {**WAVE, "proprioception": {}, "vestibular": {}, "touch": {}}
    bundle = infant(senses=senses)
    with closing(opened(bundle)) as env:
        act = policy_of(env, policy)
        action = act(np.random.default_rng(0), env.reset(seed=0)[0])
        assert action in env.action_space
        assert (action[-2:] == 0).all()
        env.step(action)
    envs = mimoc.make_vec(bundle, num_envs=2)
    actions = mimoc.policy_vec(policy, envs)([np.random.default_rng(0)] * 2, envs.reset(seed=0)[0])
    assert (actions[:, -2:] == 0).all()
    envs.close()
    assert "random" in POLICIES


@pytest.mark.parametrize("task", full_but(["reach"], sorted(TASKS)))
def test_tasks_judge_the_same_whether_it_speaks_or_not(task):
    rewards = []
    for voice, said in ((False, ()), (True, (0.5, 1.0))):
        bundle = infant(age_months=12, senses={"proprioception": {}}, voice=voice, task={"kind": task})
        with closing(opened(bundle)) as env:
            joints = np.full(len(env.actuation.low), 0.2)
            rewards.append([env.step(np.array([*joints, *said], np.float32))[1] for _ in range(2)])
    assert rewards[0] == rewards[1]


def test_wrong_actions_are_refused_with_their_shape():
    with closing(opened(infant())) as env:
        for wrong in (np.zeros(3), np.full(env.action_space.shape, np.nan)):
            with pytest.raises(ValueError, match="expected a finite action of shape"):
                env.step(wrong)


def test_it_grows_with_the_voice_that_it_has_now():
    spec = mimoc.InfantSpec.model_validate(
        {"mimoc": 1, "name": "x", "age_months": 0, "senses": WAVE, "actuation": {"voice": True}}
    )
    with closing(mimoc.make(spec).unwrapped) as env:
        env.reset(seed=0)
        spoken(env, 0.0, 1.0, 10)
        env.grow(to=6)
        assert np.abs(spoken(env, 0.0, 1.0, 10)).max() > 0.1
    assert Voice(env.manifest.actuation.voice).fundamental_hz > 400
