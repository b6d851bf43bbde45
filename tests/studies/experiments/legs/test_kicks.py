"""What kicks are, on signals of which everything is known."""

import numpy as np
import pytest

from mimoc.motion.body_points import film
from mimoc.movement.measures import core_of
from mimoc.movement.trunk_frame import trunk_paths
from mimoc.studies.experiments.legs.infants import Setup, open_infant
from mimoc.studies.experiments.legs.kicks import LegMotion, kicks_of, leg_motions, phase_of, summarise, units_of

RATE_HZ = 100.0


def leg(length, *, hip=None, knee=None, ankle=None, speed=None, acceleration=None) -> LegMotion:
    zeros = np.zeros(len(length))
    angles = {"hip": hip, "knee": knee, "ankle": ankle}
    return LegMotion(
        RATE_HZ,
        length,
        {joint: zeros if angle is None else angle for joint, angle in angles.items()},
        zeros if speed is None else speed,
        zeros if acceleration is None else acceleration,
    )


def bumps(size: float, *, every_s: float = 3.0, width_s: float = 0.7, seconds: float = 30.0):
    """Return raised cosines of some size on a level of .4, one every few seconds."""
    since = np.arange(0, seconds, 1 / RATE_HZ) % every_s
    return 0.4 + size * np.where(since < width_s, (1 - np.cos(2 * np.pi * since / width_s)) / 2, 0.0)


def test_a_kick_is_a_stretch_of_at_least_a_quarter_of_the_trunk():
    assert len(kicks_of(leg(bumps(0.3)))) == 10
    assert kicks_of(leg(bumps(0.2))) == []


def test_the_size_of_a_kick_is_how_far_the_leg_stretches():
    assert [kick.size_trunk for kick in kicks_of(leg(bumps(0.4)))] == pytest.approx([0.4] * 10, abs=1e-3)


def test_its_phases_do_not_count_the_pauses_around_it():
    """A raised cosine of .7 s is above a tenth of its speed for all but 2 x 3.2 % of each half of .35 s."""
    kicks = kicks_of(leg(bumps(0.4)))
    assert [kick.stretch_s for kick in kicks] == pytest.approx([0.33] * 10, abs=0.021)
    assert [kick.bend_s for kick in kicks] == pytest.approx([0.33] * 10, abs=0.021)


def test_the_ranges_of_joints_are_those_within_a_kick():
    length = bumps(0.4)
    hip = 100 * (length - 0.4)
    hip[-50:] = 500.0  # In a pause.
    kicks = kicks_of(leg(length, hip=hip, knee=-2 * hip))
    assert kicks[0].excursions_deg["hip"] == pytest.approx(40, abs=1)
    assert kicks[0].excursions_deg["knee"] == pytest.approx(80, abs=2)
    assert kicks[0].hip_knee_r == pytest.approx(-1)


def test_a_phase_is_around_its_largest_speed():
    speed = np.array([0.05, 0.0, 0.2, 1.0, 0.5, 0.05, 0.9])
    assert phase_of(speed) == slice(2, 5)


def test_a_leg_that_does_not_move_that_way_has_no_phase():
    assert phase_of(np.array([])) == slice(0, 0)
    assert phase_of(np.array([-1.0, -2.0])) == slice(0, 0)


def test_a_movement_unit_lasts_from_minimum_to_minimum_of_speed():
    time = np.arange(0, 10, 1 / RATE_HZ)
    speed, acceleration = 0.6 - 0.5 * np.cos(2 * np.pi * time / 0.25), np.full(len(time), 4.0)
    units = units_of(leg(speed, speed=speed, acceleration=acceleration))
    assert {round(duration_s, 2) for duration_s, _ in units} == {0.25}
    assert {peak for _, peak in units} == {4.0}


def test_legs_that_kick_in_turn_are_opposed():
    left = bumps(0.4, width_s=1.5)
    values = summarise({"left": leg(left), "right": leg(1.0 - left)})
    assert values["left_right_r"] == pytest.approx(-1)


def test_legs_that_never_kick_have_a_rate_and_nothing_else_of_kicks():
    values = summarise({"left": leg(bumps(0.1)), "right": leg(bumps(0.1))})
    assert values["rate_per_min"] == 0
    assert "hip_deg" not in values


def test_kicks_are_those_that_mimoc_movement_counts():
    env = open_infant(Setup(3.0))
    env.reset(seed=0)
    start, model = env.data.qpos.copy(), env.model
    qpos = np.repeat(start[None], round(12 * RATE_HZ), axis=0)
    for side in ("left", "right"):
        for joint, size in (("hip1", -1.0), ("knee", -1.2)):
            address = model.joint(f"robot:{side}_{joint}").qposadr[0]
            qpos[:, address] += size * (1 + np.sin(np.arange(len(qpos)) * 2 * np.pi * 0.5 / RATE_HZ)) / 2
    values = summarise(leg_motions(model, qpos, RATE_HZ))
    counted = core_of(trunk_paths(film(model, qpos, RATE_HZ)))["kicks_per_min"]
    assert values["rate_per_min"] == pytest.approx(counted)
    assert counted > 0
