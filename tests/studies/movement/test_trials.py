"""What must be true of the trials whatever the law of the body: laws of strength, weight, damping and size."""

from functools import lru_cache
from itertools import pairwise

import mujoco
import numpy as np
import pytest

from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.infant import Conditions, compile_at, grown_to
from mimoc.studies.movement.drive import QUIET, again, run, settled
from mimoc.studies.movement.grip import ROD, grip, gripping, hand_of, with_rod
from mimoc.studies.movement.kicks import best_kick, kick, lifts
from mimoc.studies.movement.posture import leg_length
from mimoc.studies.movement.report import TRIALS
from mimoc.studies.movement.saccade import STEP_S, saccade
from mimoc.studies.movement.trial import Subject

CHILD = InfantSpec(mimoc=1, name="child", age_months=0)
HANDS = ("mitten", "five_finger")


@lru_cache
def infant(age_months=3.0, strength=1.0, hands="mitten"):
    return compile_at(CHILD.with_(body={"hands": hands}), age_months, Conditions(strength=strength))


@lru_cache
def lying(age_months=3.0, strength=1.0):
    return settled(infant(age_months, strength), 1.0)


def test_more_of_the_strength_never_lowers_a_kick():
    body, start = infant(), lying()
    kicks = [best_kick(body, start, share).excursion_deg for share in (0.2, 0.4, 0.6, 0.8, 1.0)]
    assert kicks == sorted(kicks)


def test_more_torque_never_lowers_a_kick():
    """Until the hip is bent to where its limit begins to act; the limit is soft."""
    start, hip = lying(), infant().model.joint("robot:left_hip1")
    to_end_deg = np.degrees(start.joint(hip.name).qpos[0] - hip.range[0])
    kicks = [kick(infant(strength=strength), start, 0.8, 0.0).excursion_deg for strength in (0.5, 1.0, 1.5, 2.0, 4.0)]
    assert max(kicks) < to_end_deg + 1
    free_deg = to_end_deg - np.degrees(hip.margin[0])
    kicks = [min(excursion_deg, free_deg) for excursion_deg in kicks]
    assert kicks == sorted(kicks)
    assert kicks[-1] > kicks[0] + 10


def test_a_strong_enough_kick_has_a_time_and_an_acceleration():
    strong = kick(infant(strength=6.0), lying(), 1.0, 0.0)
    assert strong.seconds is not None
    assert 0.0 < strong.seconds <= 0.35
    assert strong.acceleration_m_s2 > 0


def test_damping_lowers_a_kick():
    damped = compile_at(CHILD, 3.0, Conditions())
    damped.model.dof_damping[:] *= 3
    assert kick(damped, lying(), 1.0, 0.0).excursion_deg < kick(infant(), lying(), 1.0, 0.0).excursion_deg


def test_a_stronger_eye_is_not_slower():
    """But for the steps in which the time to brake is looked for."""
    times = [saccade(infant(strength=strength), 20.0)[0] for strength in (1.0, 2.0, 4.0)]
    assert all(after <= before + 2 * STEP_S for before, after in pairwise(times))


def test_a_larger_saccade_takes_longer_and_is_faster():
    small, large = (saccade(infant(), turn_deg) for turn_deg in (5.0, 20.0))
    assert small[0] < large[0]
    assert small[1] < large[1]


def test_weights_lower_steps_and_strength_raises_them():
    plain, heavy, strong = lifts(infant()), lifts(infant(), 0.15), lifts(infant(strength=2.0))
    assert heavy[0] < plain[0] < strong[0]


def test_in_water_legs_rise_higher():
    assert lifts(infant(), water=True)[1] > lifts(infant())[1]


def test_an_infant_is_as_before_after_a_trial_with_weights():
    before = infant().model.body_mass.copy()
    lifts(infant(), 0.15)
    assert np.array_equal(before, infant().model.body_mass)


def test_straight_legs_are_longer_than_bent_ones():
    body = infant()
    straight, bent = (body.placed(-90.0, {"{side}_hip1": angle, "{side}_knee": angle}) for angle in (0.0, -100.0))
    assert leg_length(straight) > leg_length(bent)


def test_a_state_that_is_taken_up_again_goes_on_as_it_would_have():
    body, first = infant(), settled(infant(), 0.5)
    other = again(body, first)
    for data in (first, other):
        run(body, data, 0.1, QUIET)
    assert np.allclose(first.qpos, other.qpos, atol=1e-6)


@pytest.mark.parametrize("hands", HANDS)
def test_a_rod_is_put_into_the_hand_without_touching_it(hands):
    spec = grown_to(CHILD.with_(body={"hands": hands}), 1.0, Conditions())
    hand = hand_of(infant(1.0, hands=hands))
    held = with_rod(spec, hand)
    data = gripping(held, hand)
    assert data is not None
    rod = held.model.geom(ROD).id
    assert not any(rod in pair for pair in data.contact.geom.tolist())
    at_m = data.qpos[-3:] - hand.knuckle_m
    assert at_m @ hand.out_of_palm > 0
    assert np.linalg.norm(at_m) < hand.length_m
    assert np.allclose(data.geom_xmat[rod].reshape(3, 3)[:, 2], hand.axis, atol=1e-6)


@pytest.mark.full
@pytest.mark.parametrize(("hands", "strengths"), [("mitten", (0.4, 1.0)), ("five_finger", (1.0, 3.0))])
def test_a_stronger_hand_holds_more_along_the_fingers(hands, strengths, monkeypatch):
    """Up to some strength: a mitten of much more than a newborn's squeezes the rod out."""
    monkeypatch.setattr("mimoc.studies.movement.grip.PULLS_N", (1.0, 3.0, 6.0, 12.0, 20.0, 28.0))
    forces = []
    for strength in strengths:
        spec = grown_to(CHILD.with_(body={"hands": hands}), 1.0, Conditions(strength=strength))
        hand = hand_of(infant(1.0, strength, hands))
        forces.append(grip(with_rod(spec, hand), hand)["along"])
    assert 0 < forces[0] < forces[1]


@pytest.mark.parametrize("model", ["position", "muscle"])
@pytest.mark.parametrize("name", ["kick", "rest", "saccade", "stepping", "recoil"])
def test_trials_work_in_every_actuation_model(name, model):
    spec = CHILD.with_(actuation={"model": model})
    subject = Subject(compile_at(spec, 1.0, Conditions()), grown_to(spec, 1.0, Conditions()))
    values = TRIALS[name].measure(subject)
    assert list(values) == [measure.name for measure in TRIALS[name].measures]
    assert all(value is None or np.isfinite(value) for value in values.values())


def test_trials_end_without_warnings_of_the_simulation():
    data = settled(infant(), 1.0)
    assert not any(data.warning[kind].number for kind in (mujoco.mjtWarning.mjWARN_BADQACC,))
