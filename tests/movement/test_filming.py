"""What can be measured: recordings, cohorts, and simulated infants as a camera above them sees them."""

from contextlib import closing
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from support import filmed
from support.moving import restless
from support.store import built

import mimoc
from mimoc.base.errors import MimocError, MovementError
from mimoc.bundle.io import write_bundle
from mimoc.motion.body_points import locate
from mimoc.motion.reading import write_points
from mimoc.movement.filming import SPACE_POINTS, TRUNK_PX, Film, SourceOptions, film_places, film_policy, films_in
from mimoc.movement.measures import core_measures

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
        Film().to_recording("short")


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


def recorded(folder: Path, seeds: range = range(1)) -> Path:
    """Return the folder of episodes of 3 s under random commands."""
    with closing(mimoc.InfantEnv(built(SPEC))) as env, mimoc.Recorder(env, folder) as recorder:
        for seed in seeds:
            generator = np.random.default_rng(seed)
            recorder.reset(seed=seed)
            for _ in range(round(3000 / env.manifest.step_ms)):
                recorder.step(generator.uniform(env.action_space.low, env.action_space.high).astype(np.float32))
    return folder


def test_a_file_is_one_recording(folder):
    (film,) = films_in(folder / "infant1.npz")
    assert np.array_equal(film.seen.positions, restless(1, 17.0).positions)
    assert film.space is None


def test_a_folder_is_all_its_recordings_in_their_order(folder):
    films = films_in(folder)
    assert len(films) == 3
    assert np.array_equal(films[2].seen.positions, restless(2, 17.0).positions)


def test_a_damaged_recording_in_a_folder_is_not_passed_over(folder):
    (folder / "infant3.npz").write_bytes(b"PK damaged")
    with pytest.raises(MimocError, match=r"infant3\.npz: "):
        films_in(folder)


def test_a_retargeted_folder_is_measured_by_the_points_that_were_recorded(tmp_path):
    (tmp_path / "recording.json").write_text("{}")
    write_points(restless(0, 10.0), tmp_path / "points.npz")
    (film,) = films_in(tmp_path)
    assert np.array_equal(film.seen.positions, restless(0, 10.0).positions)


@pytest.mark.parametrize("lies", ["in space", "in a picture"])
def test_a_retargeted_folder_is_not_asked_again_how_its_infant_lies(lies, tmp_path):
    (tmp_path / "recording.json").write_text("{}")
    space, seen = filmed.in_space(90), filmed.filmed(90)
    prone = replace(space, positions=space.positions * [1, -1, -1])
    behind = replace(seen, positions=seen.positions * [-1, 1] + [640, 0])
    write_points(prone if lies == "in space" else behind, tmp_path / "points.npz")
    (film,) = films_in(tmp_path)
    assert film.seen.frames == 90


def test_a_folder_is_also_what_mimoc_wrote_in_it(tmp_path):
    recorded(tmp_path / "run")
    (tmp_path / "child").mkdir()
    (tmp_path / "child" / "recording.json").write_text("{}")
    write_points(restless(0, 10.0), tmp_path / "child" / "points.npz")
    retargeted, run = films_in(tmp_path)
    assert retargeted.space is None
    assert run.seen.name == "run"


def test_a_recording_of_mimoc_is_simulated_again_and_filmed(tmp_path):
    folder, done = recorded(tmp_path / "run", range(2)), []
    films = films_in(folder, progress=lambda *steps: done.append(steps))
    assert [film.seen.name for film in films] == ["run, infant 0, episode 0", "run, infant 0, episode 1"]
    assert all(film.seen.frames == 61 for film in films)
    assert films[0].space is not None
    assert done[-1][0] == done[-1][1]


def test_a_cohort_is_all_recordings_in_it(tmp_path):
    (tmp_path / "cohort.json").write_text("{}")
    for name in ("first", "second"):
        (tmp_path / "runs" / name).mkdir(parents=True)
        recorded(tmp_path / "runs" / name / "recording")
    assert [film.seen.name for film in films_in(tmp_path)] == ["runs/first/recording", "runs/second/recording"]


def test_a_bundle_is_simulated_under_a_policy(tmp_path):
    folder = write_bundle(built(SPEC), tmp_path / "three")
    options = SourceOptions(policy="random", seeds=range(1), seconds=2.0)
    (film,) = films_in(Path(folder), options)
    (same,) = film_policy(built(SPEC), "random", [0], 2.0)
    assert np.array_equal(film.seen.positions, same.seen.positions)


@pytest.mark.parametrize(
    ("name", "options", "message"),
    [
        ("nowhere", None, "nowhere: does not exist; name a recording"),
        ("three.yaml", None, r"three\.yaml: an infant, not a recording; say how it moves with --policy"),
        ("empty", None, "empty: nothing in this folder is a recording"),
        ("cohort", None, "cohort: a cohort without recordings; give its step 'run' the option record: true"),
        ("empty", SourceOptions(policy="random"), "empty: --policy is for a bundle or a spec"),
    ],
)
def test_what_is_nothing_to_measure_is_one_line(tmp_path, name, options, message):
    (tmp_path / "empty").mkdir()
    (tmp_path / "cohort").mkdir()
    (tmp_path / "cohort" / "cohort.json").write_text("{}")
    (tmp_path / "three.yaml").write_text("mimoc: 1\nname: three\nage_months: 3\n")
    with pytest.raises(MovementError, match=message) as raised:
        films_in(tmp_path / name, options)
    assert "\n" not in str(raised.value)
