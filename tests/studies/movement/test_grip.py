"""What hands with five fingers hold at 0 to 3 months, how they lie around a rod, and how they rest."""

from functools import lru_cache
from itertools import pairwise

import mujoco
import numpy as np
import pytest

from mimoc.body.maturation import FISTS
from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.infant import Conditions, compile_at, grown_to
from mimoc.studies.movement import grip as trial
from mimoc.studies.movement.drive import QUIET, angle_deg, floating, run
from mimoc.studies.movement.grip import ROD, _close, _held, grip, gripping, hand_of, with_rod

CHILD = InfantSpec(mimoc=1, name="child", age_months=0, body={"hands": "five_finger"})
GIRL, BOY = (
    {"individual": {"sex": sex, "length_percentile": percentile, "weight_percentile": percentile}}
    for sex, percentile in (("female", 50), ("male", 97))
)
STRAIGHT_S = 3.0


@lru_cache
def hand_with_rod(age_months=0.0, model="torque", child=""):
    spec = CHILD.with_(actuation={"model": model}, body={"girl": GIRL, "boy": BOY}.get(child, {}))
    spec = grown_to(spec, age_months, Conditions())
    hand = hand_of(compile_at(spec, age_months, Conditions()))
    return with_rod(spec, hand), hand


@pytest.fixture
def few_pulls(monkeypatch):
    """Pull at the rod with few of the usual forces."""
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
    infant = floating(compile_at(CHILD.with_(actuation={"model": model}), 0.0, Conditions()))
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
