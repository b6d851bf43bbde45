"""Infants in one world hear each other's voices: later and weaker by the way, and first at the nearer ear."""

import math
from collections.abc import Iterator
from contextlib import closing, contextmanager

import numpy as np
import pytest
from support.worlds import placed

import mimoc
from mimoc.geometry.spherical_head import SOUND_M_S, interaural_time_s
from mimoc.runtime.world_env import WorldEnv

RATE_HZ = 24_000
SPEAKER = {"mimoc": 1, "name": "anna", "age_months": 6, "actuation": {"voice": True}, "senses": {"vestibular": {}}}
HEARING = {"output": "waveform", "thresholds": "off", "sample_rate_hz": RATE_HZ}
LISTENER = {"mimoc": 1, "name": "ben", "age_months": 9, "senses": {"hearing": HEARING}}


@contextmanager
def pair(y_cm: float) -> Iterator[WorldEnv]:
    """Yield a world in which anna, who can speak, lies beside ben, who hears."""
    bundle = placed({"anna": SPEAKER, "ben": LISTENER}, {"y_cm": y_cm}, {"y_cm": 0})
    with closing(mimoc.make_parallel(bundle)) as env:
        env.reset(seed=0)
        yield env


def heard(env: WorldEnv, steps: int, loudness: float = 1.0) -> np.ndarray:
    """Return what ben hears in some control steps in which anna is loud, shape (2, n)."""
    sounds = []
    for _ in range(steps):
        actions = {name: np.zeros(env.action_space(name).shape, np.float32) for name in env.agents}
        actions["anna"][-2:] = 0.3, loudness
        sounds.append(env.step(actions)[0]["ben"]["hearing"])
    return np.concatenate(sounds, axis=1)


def mouth_from_head(env: WorldEnv) -> np.ndarray:
    """Return where anna's mouth is from the middle of ben's head, in the frame of that, shape (3,), [m]."""
    voice = env.infants["anna"].manifest.actuation.voice
    entry = env.infants["ben"].manifest.senses.hearing
    assert voice is not None
    mouth, head = env.data.body(voice.head), env.data.body(entry.head)
    mouth_m = mouth.xpos + mouth.xmat.reshape(3, 3) @ voice.mouth_m
    return head.xmat.reshape(3, 3).T @ (mouth_m - head.xpos) - entry.centre_m


@pytest.mark.parametrize("y_cm", [-90.0, 90.0, 250.0])
def test_a_voice_arrives_after_its_way_and_first_at_the_nearer_ear(y_cm):
    with pair(y_cm) as env:
        away_m, radius_m = mouth_from_head(env), env.infants["ben"].manifest.senses.hearing.radius_m
        start = env.get_state()
        silence = heard(env, 12, loudness=0.0)  # In which limbs come to rest on the floor.
        env.set_state(start)
        sound = heard(env, 12) - silence
    distance_m = math.hypot(*away_m)
    aside_rad = math.asin(away_m[1] / distance_m)
    wanted = RATE_HZ * interaural_time_s(abs(aside_rad), radius_m)
    lag = int(np.correlate(sound[1], sound[0], "full").argmax()) - (sound.shape[1] - 1)
    assert math.copysign(wanted, aside_rad) == pytest.approx(lag, abs=1.5)
    first = int(np.flatnonzero(sound[0 if aside_rad > 0 else 1])[0])
    assert first == pytest.approx(RATE_HZ * (distance_m - radius_m * math.sin(abs(aside_rad))) / SOUND_M_S, abs=2)


def test_a_voice_is_weaker_in_proportion_to_its_way():
    levels = []
    for y_cm in (80.0, 160.0):
        with pair(y_cm) as env:
            sound = heard(env, 20)[:, -1200:]
            levels.append(np.sqrt((sound**2).mean()) * np.linalg.norm(mouth_from_head(env)))
    assert levels[0] == pytest.approx(levels[1], rel=0.05)


def test_a_voice_on_its_way_is_part_of_the_state():
    with pair(90.0) as env:
        heard(env, 4)
        state = env.get_state()
        first = heard(env, 4)
        env.set_state(state)
        assert (heard(env, 4) == first).all()
        assert first.any()
