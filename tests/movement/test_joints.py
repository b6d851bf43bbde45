"""Angles of legs in space, and how hips, knees and ankles move together."""

import numpy as np
import pytest
from support.filmed import in_space
from support.moving import restless

from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.motion.point_recording import Camera, PointRecording
from mimoc.movement.joints import joint_angles, joint_measures, lag_s

TIMES_S = np.arange(990) / 30
NAMES = (*MINI_RGBD_POINTS, "left_ankle", "right_ankle")


def legs(hip_deg: np.ndarray, knee_deg: np.ndarray) -> PointRecording:
    """Return an infant whose legs have these angles, in the plane of y and z, with thighs and shanks of .1 m."""
    zero = np.zeros(len(hip_deg))
    places = {name: np.stack([zero, zero, zero], axis=-1) for name in NAMES}
    places["neck"] = places["neck"] + (0, 0.2, 0)
    thigh_rad, shank_rad = np.radians(hip_deg), np.radians(hip_deg - 180 + knee_deg)
    for side, sign in (("left", -1), ("right", 1)):
        hip = places[f"{side}_hip"] + (0.05 * sign, 0, 0)
        knee = hip + 0.1 * np.stack([zero, np.cos(thigh_rad), np.sin(thigh_rad)], axis=-1)
        ankle = knee + 0.1 * np.stack([zero, np.cos(shank_rad), np.sin(shank_rad)], axis=-1)
        foot = ankle + 0.05 * np.stack([zero, zero, zero + 1], axis=-1)
        places |= {
            f"{side}_{part}": place
            for part, place in zip(("hip", "knee", "ankle", "foot"), (hip, knee, ankle, foot), strict=True)
        }
    positions = np.stack([places[name] for name in NAMES], axis=1)
    return PointRecording("legs", 30.0, NAMES, positions, np.ones(positions.shape[:2]))


def test_a_straight_leg_has_180_degrees():
    angles = joint_angles(legs(np.full(990, 180.0), np.full(990, 180.0)))
    assert angles["left_hip"] == pytest.approx(180)
    assert angles["right_knee"] == pytest.approx(180)


def test_hip_and_knee_that_bend_together_correlate():
    swing = 40 * np.sin(2 * np.pi * 0.5 * TIMES_S)
    together = joint_measures(legs(120 + swing, 110 + swing))
    assert together["hip_knee_r"] == pytest.approx(1, abs=1e-3)
    assert together["hips_together_r"] == pytest.approx(1)
    assert together["hip_excursion_deg"] == pytest.approx(80, rel=0.05)
    assert joint_measures(legs(120 + swing, 110 - swing))["hip_knee_r"] == pytest.approx(-1, abs=1e-3)


def test_hip_and_knee_can_correlate_in_kicks_and_not_between_them():
    beat = 0.5 * TIMES_S % 1.0
    kick, apart = np.sin(4 * np.pi * beat) ** 2 * np.array([beat < 0.25, (beat > 0.5) & (beat < 0.75)])
    values = joint_measures(legs(100 + 80 * kick + 60 * apart, 60 + 80 * kick - 30 * apart))
    assert values["kick_hip_knee_r"] > 0.98
    assert values["hip_knee_r"] < 0.6


def test_a_leg_movement_lasts_from_stop_to_stop_and_has_the_acceleration_of_its_path():
    """A shank of .1 m that swings by 20 degrees at 1 Hz: a movement each half of a second."""
    swing = 20 * np.sin(2 * np.pi * TIMES_S)
    values = joint_measures(legs(np.full(990, 120.0), 100 + swing))
    rate = 2 * np.pi * np.radians(20)
    along, inwards = 0.1 * 2 * np.pi * rate, 0.1 * rate**2
    assert values["leg_movement_s"] == pytest.approx(0.5, rel=0.05)
    assert values["leg_movement_m_s2"] == pytest.approx(max(along, inwards), rel=0.1)


def test_a_knee_that_follows_has_a_lag():
    hip, knee = (np.sin(2 * np.pi * 0.5 * (TIMES_S - delay_s)) for delay_s in (0.0, 0.2))
    assert lag_s(hip, knee, 30.0) == pytest.approx(0.2)
    assert lag_s(knee, hip, 30.0) == pytest.approx(-0.2)


def test_depth_gives_angles_of_what_one_camera_sees():
    space = in_space(90, NAMES)
    camera = Camera((600.0, 600.0), (320.0, 240.0), (640, 480))
    away = space.positions * (1, -1, -1) + (0, 0, 2.0)
    seen = PointRecording("deep", 30.0, NAMES, camera.project(away), space.confidence, camera, away[..., 2])
    angles, expected = joint_angles(seen), joint_angles(space)
    assert all(angles[name] == pytest.approx(expected[name], abs=3) for name in expected)


def test_one_camera_without_depth_gives_none():
    assert joint_measures(restless()) == joint_angles(restless()) == {}
