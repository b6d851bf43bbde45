"""Measures of movements that are known, also of one side and of joints in space, and what they do not depend on."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.filmed import in_space
from support.moving import moving, placed, restless, wave

from mimoc.base.errors import MovementError
from mimoc.base.movement_quantities import CORE, DETAILS, JOINTS
from mimoc.base.quantities import QUANTITIES
from mimoc.cli.tables import print_movement_measures
from mimoc.motion.labels import MINI_RGBD_POINTS
from mimoc.motion.point_recording import Camera, PointRecording
from mimoc.movement.filming import Filmed
from mimoc.movement.measured import (
    OF_NO_SIDE,
    joint_angles,
    joint_measures,
    lag_s,
    measure_movement,
    measure_sides,
    path_dimension,
)
from mimoc.movement.measures import core_measures, sample_entropy
from mimoc.movement.report import measure_all

SEEDS = st.integers(0, 5)


def same(first: dict[str, float], second: dict[str, float]) -> bool:
    assert first.keys() == second.keys()
    return all(first[name] == pytest.approx(second[name], rel=1e-6, abs=1e-6) for name in first)


@settings(max_examples=10, deadline=None)
@given(SEEDS, st.floats(0.2, 5.0))
def test_size_and_distance_do_not_matter(seed, scale):
    recording = restless(seed, 12.0)
    assert same(measure_movement(recording), measure_movement(placed(recording, scale * recording.positions)))


@settings(max_examples=10, deadline=None)
@given(SEEDS, st.floats(-np.pi, np.pi))
def test_how_the_camera_is_turned_does_not_matter(seed, angle_rad):
    recording = restless(seed, 12.0)
    sine, cosine = np.sin(angle_rad), np.cos(angle_rad)
    turned = recording.positions @ np.array([[cosine, sine], [-sine, cosine]])
    assert same(measure_movement(recording), measure_movement(placed(recording, turned)))


@settings(max_examples=10, deadline=None)
@given(SEEDS, st.floats(-300, 300), st.floats(-50, 50), st.floats(0, 1))
def test_where_an_infant_lies_and_travels_does_not_matter(seed, away, speed, rate_hz):
    recording = restless(seed, 12.0)
    times_s = np.arange(recording.frames) / recording.rate_hz
    travel = np.stack([away + speed * times_s, 20 * np.sin(2 * np.pi * rate_hz * times_s)], axis=-1)
    travelled = placed(recording, recording.positions + travel[:, None])
    assert same(measure_movement(recording), measure_movement(travelled))


@settings(max_examples=6, deadline=None)
@given(SEEDS)
def test_the_mirror_image_with_sides_exchanged_moves_alike(seed):
    recording = restless(seed, 12.0)
    swap = {"left": "right", "right": "left"}
    names = [name.partition("_") for name in recording.names]
    mirrored = tuple(f"{swap[side]}_{part}" if side in swap else side for side, _, part in names)
    image = placed(recording, recording.positions * (-1, 1), mirrored)
    assert same(measure_movement(recording), measure_movement(image))


@settings(max_examples=10, deadline=None)
@given(SEEDS, st.permutations(range(14)))
def test_the_order_of_points_does_not_matter(seed, order):
    recording = restless(seed, 12.0)
    assert same(measure_movement(recording), measure_movement(recording.select([recording.names[i] for i in order])))


def test_a_wave_has_its_frequency_its_spread_and_its_units():
    measures = core_measures(moving({f"{side}_hand": wave(1.5, 0.3) for side in ("left", "right")}))
    assert measures["hand_frequency_hz"] == pytest.approx(1.5, abs=0.1)
    assert measures["hand_spread_trunk"] == pytest.approx(0.3 / np.sqrt(2), rel=0.02)
    assert measures["hand_units_per_min"] == pytest.approx(180, rel=0.02)  # Two maxima of speed in each period.
    assert measures["hands_together_r"] == pytest.approx(1)
    assert measures["hand_speed_median_trunk_s"] == pytest.approx(2 * np.pi * 1.5 * 0.3 / np.sqrt(2), rel=0.05)


def test_a_leg_that_extends_and_flexes_kicks():
    measures = measure_movement(moving({"left_foot": wave(0.5, 0.2, 120.0)}, 120.0))
    assert measures["kicks_per_min"] == pytest.approx(15, rel=0.03)  # Thirty of one leg, none of the other.
    assert measures["kick_amplitude_trunk"] == pytest.approx(0.4, rel=0.05)
    assert measures["kick_extension_s"] == pytest.approx(1.0, abs=0.05)
    assert measures["kick_flexion_s"] == pytest.approx(1.0, abs=0.05)
    assert measures["kicks_together_share"] == 0


def test_an_infant_that_does_not_move_has_measures():
    measures = core_measures(moving({}))
    assert all(np.isfinite(list(measures.values())))
    assert measures["hand_moving_share"] == measures["kicks_per_min"] == measures["dimensions"] == 0
    assert {"kick_amplitude_trunk", "hand_unit_s"} & measure_movement(moving({})).keys() == set()


def test_a_wave_is_more_predictable_than_noise():
    generator = np.random.default_rng(0)
    assert sample_entropy(np.sin(np.arange(300) / 5)) < 0.3 < 1.5 < sample_entropy(generator.normal(size=300))


def test_sample_entropy_counts_pairs():
    """In 1 2 1 2 1 5, the pair [1 2] goes on with 1 both times, and the pair [2 1] with 2 and with 5."""
    assert sample_entropy(np.array([1.0, 2.0, 1.0, 2.0, 1.0, 5.0])) == pytest.approx(np.log(2))


def test_measures_are_quantities_in_their_order():
    measures = measure_movement(restless())
    assert [*measures][:21] == [quantity.name for quantity in CORE]
    assert measures.keys() <= QUANTITIES.keys()
    assert all(QUANTITIES[name].over == "recording" and not QUANTITIES[name].steps for name in measures)


def test_gaps_of_a_twentieth_hardly_matter():
    recording = restless()
    whole, positions = core_measures(recording), recording.positions.copy()
    positions[np.random.default_rng(0).random(positions.shape[:2]) < 0.05] = np.nan
    gapped = core_measures(placed(recording, positions))
    assert all(
        gapped[name] == pytest.approx(whole[name], rel=0.1, abs=0.05) for name in whole if name != "hand_burstiness"
    )


def test_recordings_of_other_rates_measure_alike():
    fast, slow = core_measures(restless(rate_hz=60.0)), core_measures(restless(rate_hz=30.0))
    close = [name for name in slow if name.endswith(("_trunk", "_trunk_s", "_share", "_hz", "_r", "dimensions"))]
    assert all(fast[name] == pytest.approx(slow[name], rel=0.05, abs=0.02) for name in close)


@pytest.mark.parametrize(
    ("recording", "message"),
    [
        (restless(rate_hz=10.0), "10 frames/s are too few"),
        (restless(seconds=1.0), "30 frames are too few"),
        (restless().select(["neck", "left_hip", "right_hip"]), "has no left_elbow, left_hand"),
    ],
)
def test_what_cannot_be_measured_is_one_line(recording, message):
    with pytest.raises(MovementError, match=message) as raised:
        measure_movement(recording)
    assert "\n" not in str(raised.value)
    assert str(raised.value).startswith("moving: ")


def test_a_point_that_is_never_seen_is_named():
    recording = restless()
    positions = recording.positions.copy()
    positions[:, recording.names.index("left_knee")] = np.nan
    with pytest.raises(MovementError, match="left_knee never seen"):
        measure_movement(placed(recording, positions))


def test_wrists_and_ankles_stand_in_for_hands_and_feet():
    recording = restless()
    names = tuple(name.replace("hand", "wrist").replace("foot", "ankle") for name in recording.names)
    assert measure_movement(placed(recording, recording.positions, names)) == measure_movement(recording)


def test_points_in_space_are_seen_from_above():
    flat = restless()
    heights = np.random.default_rng(0).normal(size=(*flat.positions.shape[:2], 1))
    metres = np.concatenate([flat.positions * (0.002, -0.002), heights], axis=-1)
    space = PointRecording("space", 30.0, flat.names, metres, flat.confidence)
    assert same(core_measures(space), core_measures(flat))


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


LIMBS = "left_hand", "right_hand", "left_foot", "right_foot"


def test_noise_is_more_complex_than_a_walk_and_a_walk_than_a_smooth_path():
    noise = np.random.default_rng(0).normal(size=(2000, 2))
    assert path_dimension(np.linspace((0, 1), (1, 3), 2000)) == pytest.approx(1)
    assert path_dimension(np.cumsum(noise, axis=0)) == pytest.approx(1.5, abs=0.05)
    assert path_dimension(noise) == pytest.approx(2, abs=0.05)


def test_limbs_that_start_and_stop_together_rest_together_more_than_by_chance():
    times_s = np.arange(990) / 30
    bursts = (np.sin(2 * np.pi * 0.2 * times_s) > 0)[:, None] * wave(2, 0.3)
    measures = measure_movement(moving(dict.fromkeys(LIMBS, bursts)))
    assert measures["limbs_still_share"] == pytest.approx(0.5, abs=0.15)
    assert measures["limbs_still_chance_share"] == pytest.approx(measures["limbs_still_share"] ** 4, rel=0.05)
    assert measures["limbs_moving_share"] > 3 * measures["limbs_moving_chance_share"]


def test_pauses_and_movements_last_as_long_as_they_do():
    """Both hands move up for a second at .8 trunk/s, rest for two, move down for a second, rest for two."""
    height = np.interp(np.arange(990) / 30 % 6, [0, 1, 3, 4, 6], [0, 0.8, 0.8, 0, 0])
    path = np.stack([np.zeros(990), -height], axis=-1)
    measures = measure_movement(moving({"left_hand": path, "right_hand": path}))
    assert measures["hand_moving_mean_s"] == pytest.approx(1, abs=0.1)
    assert measures["hand_still_mean_s"] == pytest.approx(2, abs=0.1)
    assert measures["hand_moving_share"] == pytest.approx(1 / 3, abs=0.03)


def test_the_centroid_of_one_moving_limb_is_that_limb():
    measures = measure_movement(moving({"left_hand": wave(1, 0.3)}))
    assert measures["centroid_spread_trunk"] == pytest.approx(measures["hand_spread_trunk"] * 2, rel=0.1)


def test_places_of_hands_and_feet():
    to_face = np.tile([-0.8, -0.8], (990, 1))
    measures = measure_movement(moving({"left_hand": to_face}))
    assert measures["hand_to_face_share"] == 1
    assert measures["hand_above_shoulder_share"] == 0.5
    assert measures["feet_apart_trunk"] == pytest.approx(0.6)
    assert measures["feet_touching_share"] == 0
    assert measures["leg_length_median_trunk"] == pytest.approx(np.hypot(0.1, 0.8))


def test_legs_that_kick_in_turn_are_not_together():
    both = measure_movement(moving({"left_foot": wave(0.5, 0.2), "right_foot": wave(0.5, 0.2)}))
    in_turn = measure_movement(moving({"left_foot": wave(0.5, 0.2), "right_foot": -wave(0.5, 0.2)}))
    assert (both["legs_together_r"], both["kicks_together_share"]) == (pytest.approx(1), 1)
    assert (in_turn["legs_together_r"], in_turn["kicks_together_share"]) == (pytest.approx(-1, abs=1e-4), 0)


def test_pictures_have_all_details_and_no_angles():
    measures = measure_movement(moving({limb: wave(1, 0.2) for limb in LIMBS}))
    missing = {quantity.name for quantity in DETAILS} - measures.keys()
    assert missing <= {"hand_still_mean_s", "hand_still_p90_s", "foot_still_mean_s", "foot_still_p90_s"}
    assert {quantity.name for quantity in JOINTS} & measures.keys() == set()


RECORDING = restless(0, 12.0)
SWAP = {"left": "right", "right": "left"}


def still_right_arm():
    """Return the recording with a right hand and elbow that rest where they are on average."""
    positions = np.array(RECORDING.positions)
    for name in ("right_hand", "right_elbow"):
        column = RECORDING.names.index(name)
        hip = RECORDING.names.index("right_hip")
        positions[:, column] = positions[:, hip] + np.mean(positions[:, column] - positions[:, hip], axis=0)
    return placed(RECORDING, positions)


def test_means_over_sides_are_those_of_the_sides():
    both, sides = measure_movement(RECORDING), measure_sides(RECORDING)
    for name in ("hand_units_per_min", "foot_spread_trunk", "kicks_per_min", "hand_moving_share", "hand_burstiness"):
        assert both[name] == pytest.approx((sides["left"][name] + sides["right"][name]) / 2), name


def test_what_is_about_both_sides_has_none():
    named = measure_sides(RECORDING)["left"].keys()
    assert not [name for name in named if name.startswith(OF_NO_SIDE)]
    assert {item.name for item in CORE} - named == {"hands_together_r", "feet_together_r", "dimensions"}


def test_in_a_mirror_the_sides_are_exchanged():
    names = [name.partition("_") for name in RECORDING.names]
    mirrored = tuple(f"{SWAP[side]}_{part}" if side in SWAP else side for side, _, part in names)
    image = measure_sides(placed(RECORDING, RECORDING.positions * (-1, 1), mirrored))
    for side, values in measure_sides(RECORDING).items():
        assert image[SWAP[side]] == pytest.approx(values, rel=1e-6, abs=1e-6)


def test_a_still_arm_is_seen_on_its_side_and_its_columns_are_shown(capsys):
    alike, still = (measure_all([Filmed(recording)]) for recording in (RECORDING, still_right_arm()))
    left, right = (still.side_means[side]["hand_speed_median_trunk_s"] for side in ("left", "right"))
    assert left > 5 * right
    assert (alike.sides_differ, still.sides_differ) == (False, True)
    assert still.to_data()["measures"]["hand_units_per_min"]["right"]["mean"] == 0.0
    print_movement_measures(alike, full=False)
    assert "right" not in capsys.readouterr().out.splitlines()[2]
    print_movement_measures(still, full=False)
    assert [word for word in capsys.readouterr().out.splitlines()[2].split() if word in SWAP] == ["left", "right"]
