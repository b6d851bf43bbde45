"""Measures of movement: what they are of movements that are known, and what they do not depend on."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.moving import moving, placed, restless, wave

from mimoc.base.errors import MovementError
from mimoc.base.quantities import QUANTITIES
from mimoc.base.quantities.movement import CORE
from mimoc.motion.point_recording import PointRecording
from mimoc.movement import core_measures, measure_movement
from mimoc.movement.measures import sample_entropy

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
