"""Laws of reading: writing is undone, and neither order, gaps nor scale change what is there."""

from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support import filmed

import mimoc
from mimoc.motion.labels import POINTS
from mimoc.motion.point_recording import Camera
from mimoc.motion.read_coco import COCO_17

few = settings(max_examples=15)
PIXELS, SPACE = filmed.filmed(20), filmed.in_space(20)
SEEN = filmed.filmed(20, filmed.BODY_25_POINTS)


def with_gaps(recording, seed: int, share: float = 0.2):
    """Return a recording of which parts are not seen, but for neck and hips in the first frames."""
    gaps = np.random.default_rng(seed).random(recording.confidence.shape) < share
    gaps[:5] = False
    depth_m = None if recording.depth_m is None else np.where(gaps, np.nan, recording.depth_m)
    positions = np.where(gaps[..., None], np.nan, recording.positions)
    return replace(recording, positions=positions, confidence=1.0 - gaps, depth_m=depth_m)


def same(one, other, within: float = 0.0) -> bool:
    chosen = other.select([name for name in one.names if name in other.names])
    return chosen.names == one.names and bool(
        np.allclose(one.positions, chosen.positions, rtol=0, atol=within, equal_nan=True)
        and np.array_equal(one.confidence, chosen.confidence)
    )


def to_openpose(recording, folder: Path) -> Path:
    return filmed.write_openpose(recording, folder / "a")


def to_coco(recording, folder: Path) -> Path:
    return filmed.write_coco(recording, folder / "a")


def to_coco_file(recording, folder: Path) -> Path:
    return filmed.write_coco(recording, folder / "a.json")


def to_mini_rgbd(recording, folder: Path) -> Path:
    return filmed.write_mini_rgbd(recording, folder / "a")


def to_csv(recording, folder: Path) -> Path:
    return mimoc.write_points(recording, folder / "a.csv")


def to_npz(recording, folder: Path) -> Path:
    return mimoc.write_points(recording, folder / "a.npz")


def to_c3d(recording, folder: Path) -> Path:
    return filmed.write_c3d(recording, folder / "a.c3d")


WRITERS = [
    (to_openpose, filmed.without_neck(SEEN), 1e-3),
    (to_coco, SEEN.select(COCO_17), 1e-3),
    (to_coco_file, SEEN.select(COCO_17), 1e-3),
    (to_mini_rgbd, PIXELS, 0.0),
    (to_csv, PIXELS, 0.0),
    (to_csv, SPACE, 0.0),
    (to_npz, PIXELS, 0.0),
    (to_npz, SPACE, 0.0),
    (to_c3d, SPACE, 1e-6),
]


@pytest.mark.parametrize(("write", "recording", "within"), WRITERS)
@few
@given(seed=st.integers(0, 2**32))
def test_what_is_written_is_read(write, recording, within, seed):
    gappy = with_gaps(recording, seed)
    with TemporaryDirectory() as folder:
        read = mimoc.read_points(write(gappy, Path(folder)), rate_hz=30)
    assert same(gappy, read, within)


@few
@given(order=st.permutations(range(len(PIXELS.names))), seed=st.integers(0, 2**32))
def test_the_order_of_points_does_not_matter(order, seed):
    gappy = with_gaps(PIXELS, seed)
    with TemporaryDirectory() as folder:
        shuffled = mimoc.read_points(to_csv(gappy.select([gappy.names[index] for index in order]), Path(folder)))
    assert shuffled.names == tuple(name for name in POINTS if name in PIXELS.names)
    assert same(gappy, shuffled)


@few
@given(names=st.permutations([f"marker {index}" for index in range(len(PIXELS.names))]))
def test_any_labels_can_be_given_names(names):
    given_names = dict(zip(names, PIXELS.names, strict=True))
    with TemporaryDirectory() as folder:
        path = to_csv(replace(PIXELS, names=tuple(names)), Path(folder))
        assert same(PIXELS, mimoc.read_points(path, names=given_names))


@few
@given(scale=st.floats(0.2, 20), turn_deg=st.floats(-180, 180), x=st.floats(-500, 500))
def test_scale_turn_and_place_of_the_picture_do_not_matter(scale, turn_deg, x):
    """Nothing is taken for an error or repaired."""
    turn = np.deg2rad(turn_deg)
    turned = PIXELS.positions @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    moved = replace(PIXELS, positions=turned * scale + x)
    with TemporaryDirectory() as folder:
        read = mimoc.read_points(to_npz(moved, Path(folder)))
    assert same(moved, read)
    assert read.notes == ()


@few
@given(
    numbers=st.tuples(*[st.floats(1, 5000)] * 4),
    size=st.tuples(st.integers(1, 9999), st.integers(1, 9999)),
    rate_hz=st.floats(1, 1000),
    name=st.text(max_size=9),
    notes=st.lists(st.text(max_size=9), max_size=3),
)
def test_an_archive_holds_everything(numbers, size, rate_hz, name, notes):
    camera = Camera(numbers[:2], numbers[2:], size)
    depth_m = np.full(PIXELS.confidence.shape, 1.5)
    whole = replace(PIXELS, rate_hz=rate_hz, name=name, notes=tuple(notes), camera=camera, depth_m=depth_m)
    with TemporaryDirectory() as folder:
        read = mimoc.read_points(to_npz(whole, Path(folder)), view="back")
    assert (read.camera, read.rate_hz, read.name, read.notes) == (camera, rate_hz, name, tuple(notes))
    assert np.array_equal(read.depth_m, depth_m)
