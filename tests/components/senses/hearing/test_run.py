"""An infant hears what hits what and who speaks, when and on the side that it should, alone as among many."""

import copy
import pickle
from contextlib import closing
from typing import Any

import mujoco
import numpy as np
import pytest
from support import store

import mimoc
from mimoc.base.geometry.spherical_head import SOUND_M_S, interaural_time_s
from mimoc.runtime.sound import Sound

WAVE = {"output": "waveform", "thresholds": "off"}


def infant(age_months: float = 6, hearing: Any = WAVE, objects: Any = (), **keys) -> mimoc.Bundle:
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "senses": {"hearing": dict(hearing)}, **keys}
    return store.built({**data, "scene": {"objects": list(objects)}})


def cup(y_cm: float, x_cm: float = 0.0, **keys) -> dict[str, Any]:
    """Return a cup that is let go in the air, beside the head of an infant that lies along -x."""
    place = {"x_cm": x_cm, "y_cm": y_cm, "z_cm": 25}
    return {"name": "cup", "shape": "cylinder", "radius_cm": 3, "length_cm": 6, "mass_g": 40, "at": place, **keys}


def opened(bundle: Any, **options) -> mimoc.InfantEnv:
    env = mimoc.make(bundle, **options).unwrapped
    env.reset(seed=0)
    return env


def heard(env: mimoc.InfantEnv, steps: int, active: bool = False) -> np.ndarray:
    """Return what is heard in some control steps, shape (2, steps x n)."""
    chance, sounds = np.random.default_rng(1), []
    for _ in range(steps):
        action = chance.uniform(-1, 1, env.action_space.shape) if active else np.zeros(env.action_space.shape)
        sounds.append(env.step(action.astype(np.float32))[0]["hearing"])
    return np.concatenate(sounds, axis=1)


@pytest.mark.parametrize("age_months", [0, 9, 24])
@pytest.mark.parametrize("y_cm", [-60.0, 60.0])
def test_a_cup_that_falls_is_heard_first_on_its_side_by_woodworths_time(age_months, y_cm):
    with closing(opened(infant(age_months, objects=[cup(y_cm)]))) as env:
        body = env.model.body(env.manifest.objects[0].body).id
        heard(env, 10)
        while not any(body in pair for pair in env.model.geom_bodyid[env.data.contact.geom]):
            assert env.data.time < 1
            sound = heard(env, 1)
        place_m, entry = env.data.xpos[body], env.manifest.senses.hearing
        head = env.data.body(entry.head)
        towards_m = head.xmat.reshape(3, 3).T @ (place_m - head.xpos) - entry.centre_m
        sound = np.concatenate([sound, heard(env, 2)], axis=1)
    aside_rad = np.arcsin(towards_m[1] / np.linalg.norm(towards_m))
    wanted = entry.sample_rate_hz * interaural_time_s(abs(aside_rad), entry.radius_m)
    size = sound.shape[1]
    lags = np.correlate(sound[1], sound[0], "full")
    lag = int(lags.argmax()) - (size - 1)
    assert np.sign(aside_rad) == np.sign(y_cm * head.xmat[4])
    assert np.sign(aside_rad) * wanted == pytest.approx(lag, abs=1.5)


class Speaker(mimoc.Companion):
    """Says something once, at some physics step."""

    def __init__(self, start_step: int, place_m: tuple[float, float, float]):
        self.sound = Sound(start_step, 80.0, 300.0, 70.0, "tone", "speaker", 0, place_m)

    def sounds(self, data):
        return [self.sound] if data.time >= self.sound.start_step * 0.005 - 1e-9 else []


def test_who_speaks_is_heard_after_the_way_to_the_ears_to_the_sample():
    place_m, start_step = (3.0, 0.0, 0.3), 12
    with closing(opened(infant(), companions={"speaker": Speaker(start_step, place_m)})) as env:
        sound = heard(env, 14)
        entry = env.manifest.senses.hearing
        head = env.data.body(entry.head)
        distance_m = np.linalg.norm(place_m - head.xpos - head.xmat.reshape(3, 3) @ entry.centre_m)
    with closing(opened(infant())) as alone:
        sound = sound - heard(alone, 14)
    first = np.flatnonzero(np.abs(sound[0]) > 1e-7)[0]
    wanted = entry.sample_rate_hz * (start_step * 0.005 + distance_m / SOUND_M_S)
    around = entry.sample_rate_hz * entry.radius_m / SOUND_M_S * np.pi / 2
    assert wanted - around <= first <= wanted + around + 8


def test_a_delay_is_that_of_the_observation():
    sounds = {}
    for delay_ms in (0, 10, 25):
        bundle = infant(delays={"hearing_ms": delay_ms})
        with closing(opened(bundle, companions={"speaker": Speaker(4, (1.0, 0.5, 0.2))})) as env:
            sounds[delay_ms] = heard(env, 12)
    for delay_ms, sound in sounds.items():
        late = 24 * delay_ms
        assert np.abs(sound[:, late:] - sounds[0][:, : sound.shape[1] - late]).max() < 0.02 * np.abs(sounds[0]).max()
        assert not sound[:, :late].any()


def test_a_state_a_copy_and_a_pickle_go_on_as_the_original():
    with closing(opened(infant(objects=[cup(40.0)]), companions={"speaker": Speaker(30, (0, 1, 0))})) as env:
        heard(env, 24, active=True)
        state = env.get_state()
        others = [copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
        wanted = heard(env, 20, active=True)
        assert wanted.any()
        env.set_state(state)
        assert (heard(env, 20, active=True) == wanted).all()
        for other in others:
            assert (heard(other, 20, active=True) == wanted).all()


def test_a_state_of_nothing_is_refused():
    with closing(opened(infant())) as env:
        state = env.get_state()
        for broken in (
            {},
            {"senses.hearing": {}},
            {"senses.hearing": {**state["companions"]["senses.hearing"], "index": "x"}},
        ):
            with pytest.raises(ValueError, match="state"):
                env.set_state({**state, "companions": broken})


def test_a_grown_infant_hears_on_with_a_larger_head():
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 3, "senses": {"hearing": WAVE}})
    with closing(opened(spec, companions={"speaker": Speaker(0, (0, 2, 0))})) as env:
        before = heard(env, 3)
        radius_m = env.manifest.senses.hearing.radius_m
        env.grow(to=12)
        after = heard(env, 3)
        assert env.manifest.senses.hearing.radius_m > radius_m
        assert before.any()
        assert after.any()
        ways = np.abs(np.diff(np.concatenate([before, after], axis=1)))
        assert ways[:, 700:760].max() < 3 * ways.max()


def test_the_young_do_not_hear_what_the_old_hear():
    """A tone of 30 dB at 1 kHz is below the threshold of newborns, not of 24 months."""

    class Tone(mimoc.Companion):
        def sounds(self, data):
            return [Sound(0, 500.0, 1000.0, 36.0, "tone", "speaker", 0, (0.0, 1.0, 0.5))]

    is_heard = {}
    for age_months in (0, 24):
        for output in ("cochleagram", "levels", "waveform"):
            with closing(opened(infant(age_months, {"output": output}), companions={"tone": Tone()})) as env:
                heard(env, 20)
                is_heard[age_months, output] = bool(heard(env, 5).any())
    assert {age for (age, _), sounds in is_heard.items() if sounds} == {24}
    assert sum(is_heard.values()) == 3


def test_noise_changes_the_level_of_what_is_heard_only():
    quiet, noisy = (infant(hearing={}, objects=[cup(40.0)], noise={"hearing_db": amount}) for amount in (0, 3))
    with closing(opened(quiet)) as one, closing(opened(noisy)) as other:
        plain, varied = heard(one, 40), heard(other, 40)
    assert ((plain > 0) >= (varied > 0)).all()
    loud = plain > 15
    assert np.std((varied - plain)[loud]) == pytest.approx(3, rel=0.15)


def test_objects_sound_as_what_they_are_made_of():
    """Metal rings for longer and higher than wood, and cloth is hardly heard."""
    power, after = {}, {}
    for material in ("metal", "wood", "cloth"):
        with closing(opened(infant(objects=[cup(40.0, material=material)]))) as env:
            sound = heard(env, 60)[0]
        power[material] = float((sound**2).sum())
        after[material] = float((sound[-4800:] ** 2).sum()) / power[material]
    assert power["metal"] > power["wood"] > 10 * power["cloth"]
    assert after["metal"] > 10 * after["wood"]


def test_a_harder_fall_is_louder():
    levels = []
    for height_cm in (8, 32):
        fallen = cup(40.0) | {"at": {"x_cm": 0.0, "y_cm": 40.0, "z_cm": height_cm}}
        with closing(opened(infant(objects=[fallen]))) as env:
            levels.append(20 * np.log10(np.abs(heard(env, 40)).max()))
    assert levels[1] - levels[0] == pytest.approx(20 * np.log10(2), abs=3)


def test_what_lies_still_is_silent():
    with closing(opened(infant(objects=[cup(40.0) | {"at": {"x_cm": 0.0, "y_cm": 40.0}}]))) as env:
        heard(env, 100)
        assert np.abs(heard(env, 50)).max() < 20e-6


def test_the_layout_names_ears_and_bands():
    with closing(opened(infant(hearing={"channels": 8}))) as env:
        layout = env.layout("hearing")
        assert len(layout) == 16
        assert layout[0] == "left 100 Hz [dB]"
        assert layout[-1] == "right 8000 Hz [dB]"
        assert isinstance(env.data, mujoco.MjData)


TONE_PA, PLACE_M = 0.05 * np.sin(np.arange(2400)), (0.0, 1.0, 0.1)


@pytest.mark.parametrize(
    ("arguments", "reason"),
    [
        (("abc", 24_000, PLACE_M), "of a sound pressure, got other data"),
        (([[1.0, 2.0], [3.0]], 24_000, PLACE_M), "of a sound pressure, got other data"),
        ((1j * TONE_PA, 24_000, PLACE_M), "of a sound pressure, got other data"),
        ((TONE_PA[None], 24_000, PLACE_M), r"of a sound pressure, got shape \(1, 2400\)"),
        ((np.zeros(60_001), 1000, PLACE_M), r"2 to 60,000 samples \(60 s at most\)"),
        ((np.zeros(3_000_001), 96_000, PLACE_M), "2 to 3,000,000 samples"),
        ((1e300 * TONE_PA, 24_000, PLACE_M), "at most 100000 Pa"),
        ((np.nan * TONE_PA, 24_000, PLACE_M), "finite sound pressures"),
        ((TONE_PA, "fast", PLACE_M), "a sample rate from 1000 to 400000 Hz, got 'fast'"),
        ((TONE_PA, None, PLACE_M), "a sample rate from 1000 to 400000 Hz, got None"),
        ((TONE_PA, float("nan"), PLACE_M), "a sample rate"),
        ((TONE_PA, 24_000, None), "a place of three numbers"),
        ((TONE_PA, 24_000, (1e300, 0, 0)), "a place of three numbers"),
    ],
)
def test_what_is_no_sound_or_would_take_all_memory_is_refused(arguments, reason):
    with closing(opened(infant())) as env, pytest.raises(ValueError, match=reason):
        env.play(*arguments)
