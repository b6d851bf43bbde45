"""Simulated infants as a camera above them sees them."""

import numpy as np
import pytest
from support import filmed
from support.store import built

from mimoc.base.errors import MovementError
from mimoc.motion.body_points import locate
from mimoc.movement import core_measures
from mimoc.movement.filming import SPACE_POINTS, TRUNK_PX, Film, film_places, film_policy

SPEC = {"mimoc": 1, "name": "three", "age_months": 3, "senses": {"proprioception": {}}, "scene": {"pose": "supine"}}


def places(frames: int = 120) -> np.ndarray:
    return locate(filmed.kicking_model(), filmed.kicking(frames), SPACE_POINTS)


def test_the_camera_sees_whole_pixels_and_a_trunk_as_long_as_real_infants():
    film = film_places("kicking", np.arange(120) / 30, places())
    assert np.array_equal(film.seen.positions, np.rint(film.seen.positions))
    assert film.seen.trunk == pytest.approx(TRUNK_PX, rel=0.05)
    assert (film.seen.frames, film.seen.rate_hz, film.seen.unit) == (120, 30.0, "px")


def test_the_head_is_up_where_it_is_away_from_the_viewer():
    """World x to the right and y away from who looks down."""
    film = film_places("kicking", np.arange(120) / 30, places())
    space, seen = film.space, film.seen
    assert space is not None
    sideways = space.path("left_hip")[:, :2] - space.path("right_hip")[:, :2]
    picture = seen.path("left_hip") - seen.path("right_hip")
    away = np.linalg.norm(sideways, axis=1) * np.linalg.norm(picture, axis=1)
    assert ((sideways * picture * (1, -1)).sum(axis=1) / away).min() > 0.95


def test_where_the_infant_is_does_not_matter():
    first = film_places("here", np.arange(120) / 30, places())
    second = film_places("elsewhere", np.arange(120) / 30, places() + np.array([0.7, -1.2, 0.5]))
    assert np.abs(first.seen.positions - second.seen.positions).max() <= 1  # Rounded to the other pixel.


def test_any_control_rate_is_filmed_at_thirty_frames_a_second():
    qpos = filmed.kicking(400)
    model = filmed.kicking_model()
    fast = film_places("fast", np.arange(400) / 100, locate(model, qpos, SPACE_POINTS))
    slow = film_places("slow", np.arange(200) / 50, locate(model, qpos[::2], SPACE_POINTS))
    assert fast.seen.frames == 120
    assert slow.seen.frames == 120
    assert np.abs(fast.seen.positions - slow.seen.positions).max() <= 2


def test_an_episode_that_is_too_short_is_refused():
    with pytest.raises(MovementError, match=r"short: too short .*; record at least 3 s, since the first 1 s is not"):
        Film().develop("short")


def test_an_infant_under_a_policy_is_filmed_once_for_each_seed():
    seen: list[tuple[int, int]] = []
    films = list(film_policy(built(SPEC), "random", range(2), 3.0, lambda *done: seen.append(done)))
    assert [film.seen.name for film in films] == ["random, seed 0", "random, seed 1"]
    assert [film.seen.frames for film in films] == [91, 91]
    assert seen[-1][0] == seen[-1][1]
    assert not np.array_equal(films[0].seen.positions, films[1].seen.positions)
    assert core_measures(films[0].seen)["hand_moving_share"] > 0


def test_the_same_seed_is_filmed_alike():
    first, second = (next(film_policy(built(SPEC), "random", [3], 2.0)) for _ in range(2))
    assert np.array_equal(first.seen.positions, second.seen.positions)


def test_an_episode_that_ends_too_early_is_refused():
    with pytest.raises(MovementError, match=r"seed 0: the episode ended after .* s; give fewer --seconds, or no task"):
        list(film_policy(built({**SPEC, "task": {"kind": "reach", "steps": 150}}), "random", [0], 3.0))
