"""What must be true of the trials that are held out, whatever the law of the body."""

from functools import lru_cache

import mujoco
import numpy as np
import pytest

from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.infant import Conditions, compile_at
from mimoc.studies.movement import kicks, roll
from mimoc.studies.movement.arms import arm_lift, fastest_reach, reach
from mimoc.studies.movement.drive import settled
from mimoc.studies.movement.kicks import SIDES, excursions, lifts, tilted, with_weights
from mimoc.studies.movement.posture import places, speeds
from mimoc.studies.movement.report import TRIALS, USUAL
from mimoc.studies.movement.roll import POSTURES, Roller, search_roll
from mimoc.studies.movement.trial import Subject

CHILD = InfantSpec(mimoc=1, name="child", age_months=0)


@lru_cache
def infant(age_months=3.0, strength=1.0):
    return compile_at(CHILD, age_months, Conditions(strength=strength))


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
