from contextlib import closing

import gymnasium
import numpy as np
import pytest
from support.worlds import ANNA, BEN, world

import mimoc
from mimoc.base.errors import OutputError, UnknownNameError
from mimoc.policies import random
from mimoc.policies.rollout import Run

SIZE = {"height_px": 64}


def stopping(error, after: int):
    """Return a policy that fails after some steps."""

    def make(env):
        act, taken = random.bind(env), iter(range(after))

        def policy(generator, observation):
            if next(taken, None) is None:
                raise error
            return act(generator, observation)

        return policy

    return make


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_a_film_lasts_as_long_as_what_it_shows(name, env, tmp_path, watch):
    """A picture at the start, and one every 40 ms."""
    told = []
    summary = mimoc.record(env, "random", tmp_path / name, steps=40, **SIZE, progress=lambda *done: told.append(done))
    seen, ends_s = watch(tmp_path / name)
    assert seen.shape == (11, 64, 86 if name == "film.mp4" else 85, 3)
    assert ends_s[-1] == pytest.approx(0.44)
    assert (seen[1:] != seen[:-1]).any(axis=(1, 2, 3)).all()
    assert told == [(step, 40) for step in range(1, 41)]
    assert summary.steps == 40


def test_there_is_at_most_a_picture_each_step(env, tmp_path, watch):
    mimoc.record(env, "zero", tmp_path / "film.mp4", steps=5, rate_hz=1000, **SIZE)
    seen, ends_s = watch(tmp_path / "film.mp4")
    assert len(seen) == 6
    assert ends_s[-1] == pytest.approx(0.06)


def test_the_eyes_view_is_beside_it(env, tmp_path, watch):
    mimoc.record(env, "zero", tmp_path / "film.gif", steps=4, eyes=True, **SIZE)
    assert watch(tmp_path / "film.gif")[0].shape[1:] == (64, 85 + 4 + 30, 3)


def test_filming_changes_nothing_of_what_happens(env, bundle, tmp_path):
    filmed = mimoc.record(mimoc.make(bundle), "random", tmp_path / "film.gif", steps=8, seed=3, **SIZE)
    run = Run(env, "random", 3)
    for _ in range(8):
        run.step()
    alone = run.summary()
    assert (filmed.hip_path_m, filmed.joint_speed_rad_s) == (alone.hip_path_m, alone.joint_speed_rad_s)


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_control_c_keeps_what_was_filmed(name, env, tmp_path, watch):
    with pytest.raises(KeyboardInterrupt):
        mimoc.record(env, stopping(KeyboardInterrupt(), 12), tmp_path / name, steps=1000, **SIZE)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert len(watch(tmp_path / name)[0]) == 4


@pytest.mark.parametrize("name", ["film.mp4", "film.gif"])
def test_an_error_leaves_nothing_and_what_was_there(name, env, tmp_path):
    (tmp_path / name).write_bytes(b"older")
    with pytest.raises(ZeroDivisionError):
        mimoc.record(env, stopping(ZeroDivisionError(), 12), tmp_path / name, steps=1000, **SIZE)
    assert [(path.name, path.read_bytes()) for path in tmp_path.iterdir()] == [(name, b"older")]


def test_bad_names_are_refused_before_anything_runs(env, tmp_path):
    with pytest.raises(OutputError, match=r"film\.webm: not a supported video format"):
        mimoc.record(env, stopping(AssertionError(), 0), tmp_path / "film.webm")
    with pytest.raises(UnknownNameError, match="'rnadom' is not a policy"):
        mimoc.record(env, "rnadom", tmp_path / "film.gif")
    assert not list(tmp_path.iterdir())


def test_what_cannot_be_written_is_one_clear_error(env):
    with pytest.raises(OutputError, match=r"^/proc/film\.(gif|mp4): cannot be written "):
        mimoc.record(env, "zero", "/proc/film.gif", steps=1, **SIZE)
    with pytest.raises(OutputError, match=r"^/proc/film\.(gif|mp4): cannot be written "):
        mimoc.record(env, "zero", "/proc/film.mp4", steps=1, **SIZE)


def test_only_infants_are_filmed(tmp_path):
    with pytest.raises(TypeError, match="record: expected an environment of mimoc's on the CPU, got CartPoleEnv"):
        mimoc.record(gymnasium.make("CartPole-v1"), "zero", tmp_path / "film.gif")


def test_pictures_follow_each_other_in_real_time(env, tmp_path, watch):
    """At 30 pictures a second of an infant that acts 100 times a second."""
    mimoc.record(env, "random", tmp_path / "film.mp4", steps=50, rate_hz=30, **SIZE)
    seen, ends_s = watch(tmp_path / "film.mp4")
    assert len(seen) == 16
    assert np.diff(ends_s) == pytest.approx(np.full(15, 1 / 30), abs=1e-3)


@pytest.fixture(scope="module")
def pair():
    """Return two infants side by side."""
    return world(anna=ANNA, ben=BEN)


def test_a_film_of_a_world_shows_all_and_one_of_a_batch_shows_rows(pair, tmp_path, watch):
    """Each world in one picture, and worlds beside each other."""
    alone = SIZE["height_px"] * 4 // 3
    with closing(mimoc.make_parallel(pair)) as env:
        several = mimoc.record(env, {"anna": "random"}, tmp_path / "world.gif", steps=8, **SIZE)
    with closing(mimoc.make_vec(pair, num_envs=4)) as envs:
        rows = mimoc.record(envs, "zero", tmp_path / "batch.gif", steps=8, **SIZE)
    assert {name: summary.steps for name, summary in several.items()} == {"anna": 8, "ben": 8}
    assert several["anna"].measures["joint_speed_rad_s"] > several["ben"].measures["joint_speed_rad_s"]
    assert [*rows] == ["0", "1", "2", "3"]
    one, two = watch(tmp_path / "world.gif")[0], watch(tmp_path / "batch.gif")[0]
    assert one.shape == (3, SIZE["height_px"], alone, 3)
    assert two.shape[0] == 3
    assert two.shape[2] > 2 * alone


def test_whose_eyes_a_film_has_is_chosen_by_name(pair, tmp_path):
    with closing(mimoc.make_parallel(pair)) as env:
        films = {}
        for infant in (None, "anna", "ben"):
            file = tmp_path / f"{infant}.gif"
            mimoc.record(env, "zero", file, steps=1, eyes=True, infant=infant, **SIZE)
            films[infant] = file.read_bytes()
        with pytest.raises(UnknownNameError, match="'bem' is not a name of an infant of this environment; did you"):
            mimoc.record(env, "zero", tmp_path / "bem.gif", infant="bem")
    assert films[None] == films["anna"] != films["ben"]
