"""Who the infant is among several persons: nobody else is taken for it, and what is doubtful is said."""

import json
from dataclasses import replace

import numpy as np
import pytest
from support.filmed import BODY_25_POINTS, beside, coco_entries, filmed, missed, write_openpose

import mimoc
from mimoc.base.errors import RecordingError
from mimoc.bundle.regular_files import UnusableFileError
from mimoc.motion.persons import identity
from mimoc.motion.tracks import Detections, find_tracks, seen_twice

LOST = "nobody who is seen can be the infant, being too far from where it was, or of another size"


@pytest.fixture(scope="module")
def infant():
    """Return five seconds of a kicking infant, as OpenPose sees it."""
    return filmed(150, BODY_25_POINTS)


def chance(share: float, seed: int = 0):
    return np.random.default_rng(seed).random(150) < share


def frames_of(read, person) -> np.ndarray:
    """Return in which frames a recording has a person, and where this is not there, nobody."""
    names = [name for name in read.names if name in person.names and name not in ("neck", "mid_hip")]
    positions, expected = read.select(names).positions, person.select(names).positions
    seen = np.isfinite(positions).all(axis=(1, 2))
    assert np.isnan(positions[~seen]).all()
    return seen & (np.abs(positions - expected).max(axis=(1, 2)) < 1e-2)


def assert_is(read, person) -> None:
    """Assert that a recording is of a person in all frames in which this is seen, and of nobody in others."""
    there = np.isfinite(person.positions).any(axis=(1, 2))
    assert np.array_equal(frames_of(read, person), there)
    assert np.isnan(read.positions[~there]).all()


@pytest.mark.parametrize(
    "frames",
    [[70], chance(0.08), chance(0.4), slice(40, 100), slice(0, 30), slice(50, 150)],
    ids=["one", "some", "many", "long", "first", "last"],
)
@pytest.mark.parametrize("scale", [0.9, 1.5])
def test_an_infant_that_is_missed_is_a_gap_and_not_the_adult(frames, scale, infant, tmp_path):
    seen = missed(infant, frames)
    folder = write_openpose(seen, tmp_path / "a", (beside(infant, scale, still=True),))
    read = mimoc.read_points(folder, rate_hz=30, infant=1)
    assert_is(read, seen)
    number = int(np.isnan(seen.positions).all(axis=(1, 2)).sum())
    assert f"in {number} of 150 frames {LOST}" in read.notes


def test_whoever_is_seen_only_while_the_infant_is_not_is_not_the_infant(infant, tmp_path):
    """As with estimators that are told to find one person."""
    away = chance(0.15)
    seen, adult = missed(infant, away), missed(beside(infant, 1.2), ~away)
    read = mimoc.read_points(write_openpose(seen, tmp_path / "a", (adult,)), rate_hz=30)
    assert_is(read, seen)
    assert f"in {away.sum()} of 150 frames {LOST}" in read.notes


@pytest.mark.parametrize("scale", [1.0, 1.5])
@pytest.mark.parametrize("hides", [False, True])
def test_an_adult_who_crosses_is_not_followed(hides, scale, infant, tmp_path):
    adult = beside(filmed(150, BODY_25_POINTS, seed=1), scale, 0)
    way = np.linspace(-4, 4, 150)
    adult = replace(adult, positions=adult.positions + (way[:, None] * [100, 0])[:, None])
    seen = missed(infant, np.abs(way) < 1.5) if hides else infant
    read = mimoc.read_points(write_openpose(seen, tmp_path / "a", (adult,)), rate_hz=30, infant=1)
    assert_is(read, seen)


def test_two_infants_are_kept_apart_across_frames_without_anybody(infant, tmp_path):
    blank = np.isin(np.arange(150), [30, 31, 60, *range(90, 120)])
    one, other = (missed(infant, blank | chance(0.2, 1)), missed(beside(infant, 1.0, 1.5), blank | chance(0.2, 2)))
    folder = write_openpose(one, tmp_path / "a", (other,))
    assert_is(mimoc.read_points(folder, rate_hz=30, infant=1), one)
    assert_is(mimoc.read_points(folder, rate_hz=30, infant=0), other)


@pytest.mark.parametrize(("rate_hz", "every"), [(5, 6), (10, 3), (120, 1)])
def test_persons_are_followed_at_any_frame_rate(rate_hz, every, infant, tmp_path):
    seen = missed(infant, chance(0.1)).window(0, 150, every)
    adult = beside(infant, 1.5).window(0, 150, every)
    assert_is(mimoc.read_points(write_openpose(seen, tmp_path / "a", (adult,)), rate_hz=rate_hz, infant=1), seen)


def test_an_infant_is_followed_that_is_picked_up_and_while_the_camera_zooms(infant, tmp_path):
    middle = np.nanmean(infant.positions, axis=(0, 1))
    zoom, rise = np.linspace(1, 2, 150)[:, None, None], np.clip(np.linspace(-4, 5, 150), 0, 1)[:, None, None]
    moved = replace(infant, positions=(infant.positions - middle) * zoom + middle + rise * [0, 150])
    folder = write_openpose(moved, tmp_path / "a", (beside(moved, 0.8, 3),))
    assert_is(mimoc.read_points(folder, rate_hz=30), moved)


def test_points_that_are_seen_in_turn_are_one_person(infant, tmp_path):
    unseen = np.random.default_rng(0).random(infant.confidence.shape) < 0.25
    seen = replace(infant, positions=np.where(unseen[..., None], np.nan, infant.positions))
    read = mimoc.read_points(write_openpose(seen, tmp_path / "a", (beside(infant, still=True),)), rate_hz=30, infant=1)
    known = read.select(["nose", "left_hip", "left_ankle"])
    assert np.allclose(known.positions, seen.select(known.names).positions, rtol=0, atol=1e-2, equal_nan=True)


def test_a_body_that_is_seen_twice_is_one_person(infant, tmp_path):
    """Where it was in the frame before, as a whole or in part, and elsewhere a little beside."""
    whole = replace(infant, positions=np.roll(infant.positions, 1, axis=0) + 1)
    part = missed(whole, chance(0.5))
    part.positions[:, 15:] = np.nan
    folder = write_openpose(missed(infant, chance(0.05, 3)), tmp_path / "a", (missed(whole, chance(0.9, 5)), part))
    read = mimoc.read_points(folder, rate_hz=30)
    seen = np.isfinite(read.path("nose")[:, 0])
    assert seen.sum() > 140
    assert np.abs(read.path("nose") - infant.path("nose"))[seen].max() < 0.2 * infant.trunk
    assert not any("doubtful" in note for note in read.notes)


@pytest.mark.parametrize("radii", [0.35, 0.8])
@pytest.mark.parametrize("frames", [1, 3, 10])
def test_a_false_body_over_the_infant_does_not_lead_away_from_it(frames, radii, infant, tmp_path):
    """Of the infant's size, close to it, for some frames, in some of which the infant is missed."""
    seen, starts = missed(infant, chance(0.1)), chance(0.06, 1)
    there = np.convolve(starts, np.ones(frames))[:150] > 0
    other = replace(infant, positions=np.roll(infant.positions, 60, axis=0))
    false = missed(beside(other, 0.95, radii), ~there)
    assert_is(mimoc.read_points(write_openpose(seen, tmp_path / "a", (false,)), rate_hz=30), seen)


def test_false_persons_are_nobody(infant, tmp_path):
    generator, seen = np.random.default_rng(0), missed(infant, chance(0.1))
    false = missed(replace(infant, positions=generator.uniform(0, 480, infant.positions.shape)), chance(0.8))
    assert_is(mimoc.read_points(write_openpose(seen, tmp_path / "a", (false,)), rate_hz=30), seen)


def test_a_cut_in_a_film_ends_a_track(infant, tmp_path):
    """What is the larger part, and whether the rest is the same infant, nobody can know."""
    positions = infant.positions.copy()
    positions[100:] += [400, 0]
    read = mimoc.read_points(write_openpose(replace(infant, positions=positions), tmp_path / "a"), rate_hz=30)
    assert_is(read, missed(infant, slice(100, 150)))
    assert "this is doubtful in 33% of frames" in read.notes[0]
    assert read.notes[1] == f"in 50 of 150 frames {LOST}"


@pytest.mark.parametrize(("scale", "doubt"), [(0.3, False), (0.9, True)])
def test_the_choice_of_the_largest_is_doubtful_if_another_is_about_as_large(scale, doubt, infant, tmp_path):
    other = missed(beside(infant, scale), slice(0, 75))
    read = mimoc.read_points(write_openpose(infant, tmp_path / "a", (other,)), rate_hz=30)
    assert_is(read, infant)
    said = "; this is doubtful in 50% of frames, where others are about as large: say which is the infant"
    assert read.notes[0].endswith("is followed from there" + said * doubt)


def test_somebody_large_who_is_there_for_a_moment_is_not_the_infant(infant, tmp_path):
    adult = missed(beside(infant, 2, 4), slice(40, 150))
    assert_is(mimoc.read_points(write_openpose(infant, tmp_path / "a", (adult,)), rate_hz=30), infant)


@pytest.mark.parametrize("write", [int, float, lambda n: [n], lambda n: [float(n)], lambda n: [[n]], str])
@pytest.mark.parametrize("key", ["idx", "track_id"])
def test_identities_are_read_as_numbers_floats_and_lists(key, write, infant, tmp_path):
    adult = beside(infant, 1.5)
    entries = [*coco_entries(infant, **{key: write(1)}), *coco_entries(adult, **{key: write(2)})]
    (tmp_path / "a.json").write_text(json.dumps(entries))
    for who in (1, "1"):
        read = mimoc.read_points(tmp_path / "a.json", rate_hz=30, infant=who)
        assert_is(read, infant)
        assert not any("infant" in note for note in read.notes)
    with pytest.raises(RecordingError, match=r"has no person '5'; choose from 1, 2$"):
        mimoc.read_points(tmp_path / "a.json", rate_hz=30, infant=5)


@pytest.mark.parametrize("value", [-1, -1.0, [-1], [[-1]], "-1", None, [], {}, float("nan")])
def test_what_is_no_identity(value):
    assert identity(value) == ""


@pytest.mark.parametrize("options", [{}, {"infant": 0}])
def test_whoever_is_tracked_is_the_infant_beside_others_who_are_not(options, infant, tmp_path):
    others = beside(infant, 1.5), beside(infant, 1.5, -3)
    folder = write_openpose(infant, tmp_path / "a", others, (-1, -1, 0))
    read = mimoc.read_points(folder, rate_hz=30, **options)
    assert_is(read, infant)
    if not options:
        assert read.notes[0].startswith("the infant is taken to be '0', the only person who is tracked; this is doubt")


def test_an_identity_that_all_have_says_nothing(infant, tmp_path):
    """AlphaPose writes 0 for everybody if it does not track."""
    entries = [*coco_entries(infant, idx=[0.0]), *coco_entries(beside(infant, 0.5), idx=[0.0])]
    (tmp_path / "a.json").write_text(json.dumps(entries))
    assert_is(mimoc.read_points(tmp_path / "a.json", rate_hz=30), infant)
    assert_is(mimoc.read_points(tmp_path / "a.json", rate_hz=30, infant=1), beside(infant, 0.5))


def test_tracks_that_break_off_are_joined(infant, tmp_path):
    seen = missed(infant, [20, 21, 99])
    names = np.where(np.arange(150) < 20, 3, np.where(np.arange(150) < 99, 7, 12))
    folder = write_openpose(seen, tmp_path / "a", (beside(infant, 1.2),), (5, names.tolist()))
    read = mimoc.read_points(folder, rate_hz=30, infant=3)
    assert_is(read, seen)
    assert read.notes[0] == "the infant's track goes on under another ID 2 times, and is joined: 3; 7; 12"


def test_persons_are_counted_and_not_their_tracks(infant, tmp_path):
    names = [frame // 40 * 2 for frame in range(150)]
    folder = write_openpose(infant, tmp_path / "a", (beside(infant, 0.5),), (1, names))
    read = mimoc.read_points(folder, rate_hz=30)
    assert_is(read, infant)
    assert read.notes[0] == "the infant is taken to be '0', the largest of 2 persons"
    assert read.notes[1].endswith("3 times, and is joined: 0; 2; 4; 6")


def test_identities_that_are_exchanged_are_not_followed(infant, tmp_path):
    first = np.where(np.arange(150) < 90, 1, 2)
    folder = write_openpose(infant, tmp_path / "a", (beside(infant, 1.2),), ((3 - first).tolist(), first.tolist()))
    read = mimoc.read_points(folder, rate_hz=30, infant="1")
    assert_is(read, infant)
    assert read.notes[:2] == (
        "the infant's track goes on under another ID 1 time, and is joined: 1; 2",
        "'1' is not where the infant can be in 40% of its frames, which are left out",
    )


def test_an_adult_who_gets_the_infants_identity_is_not_the_infant(infant, tmp_path):
    seen = missed(infant, slice(50, 80))
    adult = [1 if 50 <= frame < 80 else 2 for frame in range(150)]
    folder = write_openpose(seen, tmp_path / "a", (beside(infant, 1.0),), (adult, 1))
    read = mimoc.read_points(folder, rate_hz=30, infant=1)
    assert_is(read, seen)
    assert "'1' is not where the infant can be in 20% of its frames, which are left out" in read.notes


def test_one_person_who_is_always_seen_needs_no_note(infant, tmp_path):
    read = mimoc.read_points(write_openpose(infant, tmp_path / "a", (), (4,)), rate_hz=30)
    assert_is(read, infant)
    assert not any("infant" in note for note in read.notes)


RING = np.stack([np.cos(np.arange(12)), np.sin(np.arange(12))], axis=1) * 100
"""A body with a radius of about 100 px."""


def are_linked(frames: int, radii: float, size: float = 1.0) -> bool:
    points = np.stack([RING, size * RING + [100 * radii, 0]])
    numbers = find_tracks(Detections(np.array([0, frames]), points, np.full(2, -1), 25.0)).numbers
    return bool(numbers[0] == numbers[1])


@pytest.mark.parametrize(("frames", "most"), [(1, 0.46), (5, 1.1), (50, 1.5), (5000, 1.5)])
def test_how_far_a_person_can_have_moved(frames, most):
    assert are_linked(frames, 0.95 * most)
    assert not are_linked(frames, 1.1 * most)


@pytest.mark.parametrize("frames", [1, 50])
def test_how_much_larger_or_smaller_a_person_can_look(frames):
    assert are_linked(frames, 0, 1.4)
    assert are_linked(frames, 0, 1 / 1.4)
    assert not are_linked(frames, 0, 1.5)
    assert not are_linked(frames, 0, 1 / 1.5)


@pytest.mark.parametrize("who", [0, 1])
def test_of_two_who_are_near_the_one_of_the_same_identity_is_followed(who):
    points = RING + np.array([[[0, 0]], [[30, 0]], [[-5, 0]]])
    tracks = find_tracks(Detections(np.array([0, 1, 1]), points, np.array([who, 0, 1]), 25.0))
    assert tracks.numbers[0] == tracks.numbers[1 + who]


def test_another_who_is_as_near_makes_a_link_doubtful():
    """Somebody goes on where two others might have come from."""
    body = np.array([[0.0, 0.0], [0, 10], [10, 0], [10, 10]])
    points = body + np.array([[[0, 0]], [[4, 0]], [[2, 0]]])
    tracks = find_tracks(Detections(np.array([0, 0, 1]), points, np.full(3, -1), 25.0))
    assert tracks.doubtful(int(tracks.numbers[2])).tolist() == [False, False, True]


@pytest.mark.parametrize("rate_hz", [0, -30, 1e300, float("nan"), float("inf")])
def test_a_frame_rate_of_no_camera_is_refused_as_that(rate_hz, infant, tmp_path):
    folder = write_openpose(missed(infant, [4]), tmp_path / "a", (beside(infant),))
    with pytest.raises(RecordingError, match="frames a second; give a frame rate from 1 to 1000"):
        mimoc.read_points(folder, rate_hz=rate_hz)


def test_crowds_are_refused():
    crowd = Detections(np.repeat([0, 1], 2002), np.zeros((4004, 1, 2)), np.full(4004, -1), 25.0)
    with pytest.raises(UnusableFileError, match="has more persons in its frames than can be told apart; keep those"):
        find_tracks(crowd)
    with pytest.raises(UnusableFileError, match="has more persons"):
        seen_twice(crowd._replace(places=np.zeros(4004, dtype=int)))
