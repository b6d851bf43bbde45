"""What must be true of the trials whatever the law of the body: laws of strength, weight, damping and size."""

from functools import lru_cache
from itertools import pairwise

import mujoco
import numpy as np
import pytest

from mimoc.body.maturation import FISTS
from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.trial import Conditions, compile_at, grown_to
from mimoc.studies.movement import TRIALS, USUAL, grip as trial, kicks, roll
from mimoc.studies.movement.arms import STEP_S, arm_lift, fastest_reach, reach, saccade
from mimoc.studies.movement.grip import ROD, _close, _held, grip, gripping, hand_of, with_rod
from mimoc.studies.movement.kicks import SIDES, best_kick, excursions, kick, lifts, tilted, with_weights
from mimoc.studies.movement.posture import leg_length, places, speeds
from mimoc.studies.movement.roll import POSTURES, Roller, search_roll
from mimoc.studies.movement.trial import QUIET, Subject, again, angle_deg, floating, run, settled

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


FIVE_FINGERED = InfantSpec(mimoc=1, name="child", age_months=0, body={"hands": "five_finger"})
GIRL, BOY = (
    {"individual": {"sex": sex, "length_percentile": percentile, "weight_percentile": percentile}}
    for sex, percentile in (("female", 50), ("male", 97))
)
STRAIGHT_S = 3.0


@lru_cache
def hand_with_rod(age_months=0.0, model="torque", child=""):
    spec = FIVE_FINGERED.with_(actuation={"model": model}, body={"girl": GIRL, "boy": BOY}.get(child, {}))
    spec = grown_to(spec, age_months, Conditions())
    hand = hand_of(compile_at(spec, age_months, Conditions()))
    return with_rod(spec, hand), hand


@pytest.fixture
def few_pulls(monkeypatch):
    monkeypatch.setattr(trial, "PULLS_N", (4.0, 10.0, 16.0))


@pytest.mark.full
@pytest.mark.usefixtures("few_pulls")
@pytest.mark.parametrize("model", ["torque", "muscle"])
@pytest.mark.parametrize("age_months", [0.0, 3.0])
def test_five_fingers_hold_ten_newtons_in_every_direction(age_months, model):
    """Half of a newborn's weight is 16 N."""
    forces_n = grip(*hand_with_rod(age_months, model))
    assert min(forces_n.values()) >= 10, forces_n
    assert forces_n["along"] >= 16, forces_n


@pytest.mark.usefixtures("few_pulls")
@pytest.mark.parametrize("child", ["girl", "boy"])
def test_thicker_fingers_have_room_for_the_rod(child):
    forces_n = grip(*hand_with_rod(child=child))
    assert min(forces_n.values()) >= 10, forces_n


def test_five_fingers_go_around_the_rod_and_the_thumb_lies_over_them():
    """No half of the circumference is free."""
    infant, hand = hand_with_rod()
    held = _held(infant)
    data = gripping(held, hand)
    _close(held, hand, data, 1.0)
    pairs = [{held.model.geom(geom).name for geom in contact.geom} for contact in data.contact]
    at_m = [contact.pos - data.body(ROD).xpos for contact, pair in zip(data.contact, pairs, strict=True) if ROD in pair]
    around = np.sort([np.arctan2(place @ hand.out_of_palm, place @ hand.to_wrist) for place in at_m])
    assert max(after - before for before, after in pairwise([*around, around[0] + 2 * np.pi])) < np.pi
    assert any(pair & {"left_thdistal1", "left_thhub1"} and pair & {ROD, "left_mfmiddle1"} for pair in pairs)


@pytest.mark.parametrize("model", ["torque", "muscle"])
def test_a_newborns_straightened_hand_becomes_a_fist_again(model):
    """In the air, within 3 s, and no joint goes beyond its range by more than 3 degrees."""
    infant = floating(compile_at(FIVE_FINGERED.with_(actuation={"model": model}), 0.0, Conditions()))
    data = infant.placed(0.0, {"{side}_elbow": -90.0})
    run(infant, data, STRAIGHT_S, QUIET)
    for joint in FISTS:
        name = joint.removeprefix("robot:").format(side="left")
        highest = np.degrees(infant.model.joint(f"robot:{name}").range[1])
        assert (40 if name.endswith("distal") else 50) <= angle_deg(infant, data, name) <= highest + 3, name


def test_fingers_that_close_with_all_strength_stay_within_their_range():
    infant, hand = hand_with_rod()
    held = _held(infant)
    data, worst_deg = mujoco.MjData(held.model), 0.0
    for _ in range(20):
        _close(held, hand, data, 0.05)
        for joint in hand.closing_rad:
            low, high = np.degrees(held.model.joint(f"robot:{joint}").range)
            angle = angle_deg(held, data, joint)
            worst_deg = max(worst_deg, low - angle, angle - high)
    assert worst_deg < 10


def test_a_weight_on_one_leg_is_on_that_leg_alone_and_lowers_its_steps():
    heavy = with_weights(infant(), 0.1, ("left",))
    change = heavy.model.body_mass - infant().model.body_mass
    assert change[heavy.model.body("left_lower_leg").id] == pytest.approx(0.1)
    assert np.count_nonzero(change) == 1
    assert lifts(heavy)[0] < lifts(infant())[0]


def test_a_seed_gives_the_same_kicks_each_time_and_another_seed_others():
    start = settled(infant(), 1.0)
    one, again, other = (excursions(infant(), start, 0.6, seed) for seed in (0, 0, 1))
    assert np.array_equal(one, again)
    assert not np.array_equal(one, other)


@pytest.mark.parametrize("tilt_deg", [0.0, 45.0, 90.0])
def test_gravity_points_more_to_the_feet_the_more_upright_the_board(tilt_deg):
    body = tilted(infant(), tilt_deg)
    data = body.placed(-90.0, {})
    to_feet = data.body("left_foot").xpos - data.body("head").xpos
    down = body.model.opt.gravity / np.linalg.norm(body.model.opt.gravity)
    assert np.linalg.norm(body.model.opt.gravity) == pytest.approx(9.81)
    assert down @ (np.sign(to_feet[0]), 0.0, 0.0) == pytest.approx(np.sin(np.radians(tilt_deg)))
    assert down[2] == pytest.approx(-np.cos(np.radians(tilt_deg)))


def test_stronger_legs_kick_further_on_the_board():
    ranges = []
    for strength in (0.7, 1.5):
        body = tilted(infant(strength=strength), 0.0)
        ranges.append(excursions(body, settled(infant(), 1.0), 0.6)[0])
    assert ranges[0] < ranges[1]


def test_a_pull_of_many_arms_brings_down_an_arm_that_a_small_one_does_not():
    free, pulled, overcome = (arm_lift(infant(0.0), pull) for pull in (0.0, 0.1, 3.0))
    assert overcome < pulled <= free + 0.02


def test_a_stronger_infant_reaches_no_slower():
    weak, usual, strong = (fastest_reach(infant(4.0, strength)) for strength in (0.7, 1.0, 2.0))
    assert usual is not None
    assert strong is not None
    assert strong[0] <= usual[0]
    assert weak is None or weak[0] >= usual[0]


def test_a_hasty_reach_misses_by_more_and_is_faster():
    hasty, slow = reach(infant(6.0), 0.3), reach(infant(6.0), 1.2)
    assert hasty.way_m == slow.way_m
    assert hasty.miss_m > slow.miss_m
    assert hasty.peak_m_s > slow.peak_m_s


def test_hands_and_feet_are_where_they_are_wherever_the_infant_lies():
    body = infant()
    data = body.placed(-90.0, {"left_hip1": -60.0})
    before = places(data)
    turn, lying = np.array([np.cos(0.4), 0.0, 0.0, np.sin(0.4)]), data.qpos[3:7].copy()
    data.qpos[:2] = 1.0, -2.0
    mujoco.mju_mulQuat(data.qpos[3:7], turn, lying)
    mujoco.mj_forward(body.model, data)
    assert np.allclose(before, places(data), atol=1e-6)
    assert before.shape == (2 * len(SIDES), 2)


def test_speeds_are_those_of_points_that_move_evenly():
    times_s = np.arange(400) * 0.005
    trace = np.stack([np.outer(times_s, (3.0, 4.0)), np.zeros((400, 2))], axis=1)
    assert speeds(trace, 0.005) == pytest.approx(np.tile((5.0, 0.0), (len(speeds(trace, 0.005)), 1)))


def test_a_search_for_rolling_is_the_same_each_time(monkeypatch):
    monkeypatch.setattr(roll, "DRAWS", 4)
    monkeypatch.setattr(roll, "KEPT", 2)
    one, other = (search_roll(infant(6.0), 2) for _ in range(2))
    assert one == other
    assert -90.0 <= one[0] <= 90.0


def test_an_infant_that_only_stretches_stays_on_its_back():
    roller = Roller(infant(6.0))
    assert roller.play(np.zeros(POSTURES * len(roller.moved))) < -45.0


def test_eyes_hands_and_feet_take_no_part_in_rolling():
    roller = Roller(infant(6.0))
    moving = [roller.infant.joint_names[slot] for slot in roller.moved]
    assert {"hip_rot1", "head_swivel", "left_shoulder_rotation", "right_elbow", "left_hip1", "right_knee"} <= set(
        moving
    )
    assert not any(part in name for name in moving for part in ("eye", "hand", "finger", "foot", "toes"))


def test_rolling_is_tried_only_if_it_is_asked_for():
    assert [name for name in TRIALS if name not in USUAL] == ["roll"]


@pytest.mark.full
@pytest.mark.parametrize("model", ["position", "muscle"])
@pytest.mark.parametrize("name", ["posture", "arm_pull", "reach"])
def test_held_out_trials_work_in_every_actuation_model(name, model, monkeypatch):
    monkeypatch.setattr(kicks, "KICKING_S", 2.5)
    subject = Subject(compile_at(CHILD.with_(actuation={"model": model}), 3.0, Conditions()), CHILD)
    values = TRIALS[name].measure(subject)
    assert list(values) == [measure.name for measure in TRIALS[name].measures]
    assert all(value is None or np.isfinite(value) for value in values.values())
