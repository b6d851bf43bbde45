"""Answers of a caregiver: contingent, after the set delay to the physics step, as probable as set; or yoked."""

import numpy as np
import pytest
from components.companions.conftest import kick, move, with_caregiver
from hypothesis import given, settings, strategies as st

import mimoc
from mimoc.runtime.sound import Sound

STEP_MS = 5.0


def answering(env_of, **answers) -> mimoc.InfantEnv:
    return env_of({"answers": {"to": "kick", "by": ["smile", "speak"], **answers}})


@given(delay=st.integers(0, 120))
@settings(max_examples=4)
def test_an_answer_comes_after_the_set_delay_to_the_physics_step(delay):
    spec = with_caregiver({"answers": {"delay_ms": delay * STEP_MS, "pause_ms": 0}})
    env = mimoc.make(spec).unwrapped
    env.reset(seed=0)
    kick(env, 2)
    caregiver, due, free = env.caregiver, list[int](), 0
    for step in caregiver.noticed:
        if step >= free:  # Nothing is answered while an answer is due.
            free = step + delay
            due += [free] if free < 400 else []
    assert len(due) > 1
    assert caregiver.answered == due
    voices = [sound.start_step for sound in caregiver.sounds(env.data)]
    assert voices
    assert voices == due[-len(voices) :]
    env.close()


def test_a_pause_follows_an_answer(cared_for):
    env = answering(cared_for, delay_ms=0, pause_ms=1000)
    kick(env, 4)
    assert len(env.caregiver.answered) > 1
    assert min(np.diff(env.caregiver.answered)) >= 200


@pytest.mark.parametrize(("probability", "lowest", "highest"), [(0.0, 0, 0), (0.5, 0.2, 0.8), (1.0, 1, 1)])
def test_answers_are_as_probable_as_set_and_drawn_by_the_seed(cared_for, probability, lowest, highest):
    env = answering(cared_for, delay_ms=0, pause_ms=0, probability=probability)
    kick(env, 4)
    answered = env.caregiver.answered
    assert lowest <= len(answered) / len(env.caregiver.noticed) <= highest
    env.reset(seed=0)
    kick(env, 4)
    assert env.caregiver.answered == answered


def test_a_kick_is_a_leg_that_gets_longer_by_a_quarter_of_the_trunk(cared_for):
    env = answering(cared_for, delay_ms=0, pause_ms=0)
    least_m, infant = env.manifest.caregiver.answers.kick_m, env.caregiver.infant
    lengths = []
    for _ in range(300):
        kick(env, 0.01)
        lengths.append(infant.leg_lengths_m(env.data))
    spans_m = np.ptp(lengths, axis=0)
    assert env.caregiver.noticed
    assert spans_m.max() > least_m
    env.reset(seed=0)
    move(env, 1)
    assert not env.caregiver.noticed


def test_yoked_answers_come_whatever_the_infant_does(cared_for):
    env = answering(cared_for, yoked_s=[0.1, 0.5])
    move(env, 1)
    assert env.caregiver.answered == [20, 100]
    other = answering(cared_for, yoked_s=[step * STEP_MS / 1000 for step in env.caregiver.answered])
    kick(other, 1)
    assert other.caregiver.answered == [20, 100]
    assert other.caregiver.noticed


def test_a_still_face_answers_nothing(cared_for):
    script = [{"at_s": 1, "do": "still_face"}, {"at_s": 3, "do": "interact"}]
    env = cared_for({"script": script, "answers": {"delay_ms": 100, "pause_ms": 0}})
    kick(env, 5)
    answered, noticed = np.array(env.caregiver.answered), np.array(env.caregiver.noticed)
    assert ((noticed > 200) & (noticed < 600)).any()
    assert not ((answered >= 200) & (answered < 620)).any()
    assert (answered < 200).any()
    assert (answered >= 620).any()


def test_a_look_at_its_face_is_answered_once(cared_for):
    """An infant on its back looks at a face in front of it."""
    env = answering(cared_for, to="gaze", delay_ms=0, pause_ms=0)
    move(env, 1)
    assert env.caregiver.noticed == [40]


def test_touching_it_is_answered(cared_for):
    env = cared_for({"answers": {"to": "touch", "delay_ms": 0}})
    move(env, 0.5)
    assert not env.caregiver.noticed
    env.caregiver.do("hold", "chest")
    move(env, 3)
    assert env.caregiver.answered


class Voice(mimoc.Companion):
    """The voice of an infant, at times of a script."""

    def sounds(self, data):
        steps = [step for step in (30, 150) if step * STEP_MS / 1000 <= data.time + 1e-9]
        return [Sound(step, 300.0, 400.0, 60.0, "voice", "infant", 1, (0.0, 0.0, 0.0)) for step in steps]


def test_the_voice_of_the_infant_is_answered():
    spec = with_caregiver({"answers": {"to": "vocalisation", "delay_ms": 200, "pause_ms": 0}})
    env = mimoc.make(spec, companions={"voice": Voice()}).unwrapped
    env.reset(seed=0)
    move(env, 2)
    assert env.caregiver.noticed == [30, 150]
    assert env.caregiver.answered == [70, 190]
    env.close()
