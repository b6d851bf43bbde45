"""How long the episodes of a training are, what is said of unfinished ones, and what cannot be learnt from."""

import json
import math

import numpy as np
import pytest
from gymnasium.spaces import Box

import mimoc
from mimoc.base.errors import RecordingError, TrainingError
from mimoc.policies.rollout import Run
from mimoc.training.settings import STEPS_PER_EPISODE, TrainingSettings

FREE = {"kind": "free"}
EVERY = 128  # Steps between checkpoints.


class Height:
    """A reward that changes, of a task that says nothing of its episodes."""

    def judge(self, data, action, effort):
        return float(data.qpos[2])


class Dull(Height):
    def judge(self, data, action, effort):
        return 0.5


class Goal(Height):
    spaces = {"goal": Box(0.0, 1.0, (1,), np.float32)}  # noqa: RUF012

    def observe(self):
        return {"goal": np.ones(1, np.float32)}


class Failing(Height):
    def judge(self, data, action, effort):
        if data.time > 0.5:
            raise ZeroDivisionError
        return super().judge(data, action, effort)


def lengths(training):
    return {row.episode_steps for row in training.curve.rows if row.episodes}


# The limit.


def test_where_nothing_limits_episodes_they_have_500_steps_and_that_is_said(learn, built, tmp_path):
    with pytest.warns(UserWarning, match=r"does not limit its episodes: .* after 500 control steps \(5 s\)"):
        training = learn(source=built(task=FREE), task=Height(), steps=2 * STEPS_PER_EPISODE, checkpoint_every=None)
    (row,) = training.curve.rows
    assert (row.episodes, row.episode_steps, row.unfinished) == (2, 500, 2)
    assert row.episode_return != 0
    run = json.loads((tmp_path / "run" / "run.json").read_text())
    assert run["settings"]["steps_per_episode"] == 500
    assert "--steps-per-episode 500" in run["command"]


def test_the_steps_of_the_spec_hold_for_a_task_of_ones_own(learn, built):
    """Also outside of trainings, and unless the task says otherwise."""
    infant = built(task={**FREE, "steps": 20})
    assert lengths(learn(source=infant, task=Height())) == {20}
    assert mimoc.make(infant, task=Height()).unwrapped.max_steps == 20
    shorter = Height()
    shorter.steps = 7
    assert mimoc.make(infant, task=shorter).unwrapped.max_steps == 7


@pytest.mark.parametrize("processes", [None, False])
@pytest.mark.parametrize("growth", [{}, {"grow": "17.5:18"}])
def test_the_caller_limits_episodes_wherever_they_are(learn, built, processes, growth):
    options = {"steps_per_episode": 10, "steps": EVERY, "processes": processes, **growth}
    training = learn(source=built(task=FREE), task=Height(), **options)
    assert lengths(training) == {10}


def test_a_limit_gives_the_same_policy_in_all_ways_of_stepping(learn, learned, same):
    one, other = (learned(learn(name, EVERY, steps_per_episode=9, processes=way).policy) for name, way in WAYS.items())
    assert same(one, other)


WAYS = {"together": None, "one after another": False}


def test_a_limit_beyond_that_of_the_task_is_refused(learn, tmp_path):
    with pytest.raises(TrainingError, match="the task ends episodes after 30 control steps; give at most as many"):
        learn(steps_per_episode=31)
    with pytest.raises(TrainingError, match="steps_per_episode: expected at least 1, got 0"):
        learn(steps_per_episode=0)
    assert not (tmp_path / "run").exists()


def test_a_run_is_resumed_with_the_same_limit_only(learn):
    learn(steps_per_episode=9)
    with pytest.raises(TrainingError, match="started with steps_per_episode 9, not 30"):
        learn(steps=512)
    assert learn(steps=384, steps_per_episode=9).resumed_at == 256


def test_a_policy_keeps_the_limit_of_its_training(learn, built):
    """For `evaluate` and for `mimoc run`, where the environment has none."""
    infant = built(task=FREE)
    policy = mimoc.load_policy(learn(source=infant, task=Height(), steps_per_episode=9, steps=EVERY).policy)
    env = mimoc.make(infant)
    assert [each.steps for each in mimoc.evaluate(env, policy, episodes=2)] == [9, 9]
    assert [each.steps for each in mimoc.evaluate(env, policy, episodes=1, steps_per_episode=4)] == [4]
    assert [each.steps for each in mimoc.evaluate(env, "zero", episodes=1, steps_per_episode=4)] == [4]
    limited = mimoc.make(infant, max_episode_steps=6)
    assert [each.steps for each in mimoc.evaluate(limited, policy, episodes=1)] == [6]
    run = Run(env.unwrapped, policy, seed=0)
    for _ in range(20):
        run.step()
    assert run.summary().finished == 2


def test_without_a_number_checkpoints_leave_room_for_an_episode_of_each_environment():
    chosen = TrainingSettings.choose("ppo", 10**6, 0, 64, None, {}, steps_per_episode=1000)
    assert chosen.checkpoint_every == 64_000
    assert TrainingSettings.choose("ppo", 10**6, 0, 8, None, {}).checkpoint_every == 20_480


# Episodes that have not ended.


def test_a_curve_has_the_returns_so_far_of_unfinished_episodes(learn, built):
    training = learn(source=built(task=FREE), task=Height(), steps_per_episode=100, checkpoint_every=64, steps=128)
    for row in training.curve.rows:
        assert (row.episodes, row.unfinished, row.unfinished_steps) == (0, 2, 32)
        assert math.isnan(row.episode_return)
        assert row.unfinished_return > 0


def test_each_new_row_is_handed_on(learn):
    rows = []
    training = learn(on_row=rows.append)
    assert tuple(rows) == training.curve.rows


# What cannot be learnt from.


def test_an_infant_that_observes_nothing_is_refused_and_nothing_is_written(learn, built, tmp_path):
    blind = built(senses={})
    with pytest.raises(TrainingError, match=r"'reaching' observes nothing to learn from; give its spec a sense"):
        learn(source=blind)
    assert not (tmp_path / "run").exists()
    assert learn(source=blind, task=Goal(), steps=EVERY).curve.steps == EVERY


def test_a_reward_that_stays_the_same_is_one_warning(learn, built):
    with pytest.warns(RuntimeWarning) as raised:
        learn(task=Dull(), steps=1280)
    (warning,) = raised
    assert str(warning.message).startswith("the reward of all 1,000 control steps so far is 0.5: unless it changes")


# Trainings that do not reach their end.


@pytest.mark.parametrize("task", [Height(), Failing()])
def test_what_was_learnt_before_an_interruption_is_kept(learn, built, tmp_path, task):
    """By Ctrl-C, or because a task of one's own fails; the training is resumed from the checkpoint before."""

    def stop(done, total):
        if done >= 300:
            raise KeyboardInterrupt

    infant = built(task=FREE)
    with pytest.raises((KeyboardInterrupt, ZeroDivisionError)):
        learn(source=infant, steps=1024, checkpoint_every=1024, progress=stop, task=task, steps_per_episode=60)
    assert mimoc.load_policy(tmp_path / "run" / "policy.zip")(mimoc.InfantEnv(infant))
    curve = mimoc.training.Curve.from_csv((tmp_path / "run" / "curve.csv").read_text())
    assert curve.steps > 64
    assert not (tmp_path / "run" / "state.zip").exists()


EVERY_STEPS = 128


def facts(folder) -> list[tuple]:
    found = mimoc.read_recording(folder)
    return [(each.infant, each.number, each.ended, each.actions.tobytes(), each.rewards.tobytes()) for each in found]


@pytest.mark.slow
def test_a_resumed_training_has_recorded_what_an_uninterrupted_one_has(learn, tmp_path):
    """What a killed interval has recorded is replaced, not repeated."""

    def stop(done: int, total: int) -> None:
        if done > 1.5 * EVERY_STEPS:
            raise KeyboardInterrupt

    learn("whole", record=tmp_path / "recorded whole")
    with pytest.raises(KeyboardInterrupt):
        learn("parts", record=tmp_path / "recorded parts", progress=stop)
    cut = facts(tmp_path / "recorded parts")
    learn("parts", record=tmp_path / "recorded parts")
    whole = facts(tmp_path / "recorded whole")
    assert facts(tmp_path / "recorded parts") == whole
    assert 0 < len(cut) <= len(whole)
    assert all(each.difference is None for each in mimoc.replay_recording(tmp_path / "recorded whole"))


def test_another_training_in_the_same_folder_takes_nothing_away(learn, tmp_path):
    for name, seed in (("one", 1), ("other", 2), ("again", 1)):
        learn(name, steps=EVERY_STEPS, seed=seed, record=tmp_path / "recorded")
    recording = mimoc.read_recording(tmp_path / "recorded")
    assert sum(episode.steps for episode in recording) == 3 * EVERY_STEPS
    assert np.isfinite(recording[0].rewards).all()


def test_what_cannot_be_recorded_is_said_before_anything_is_written(learn, tmp_path):
    with pytest.raises(TrainingError, match="leave out --processes and --one-process"):
        learn("run", record=tmp_path / "recorded", processes=False)
    (tmp_path / "letter.txt").write_text("dear")
    with pytest.raises(RecordingError, match="the folder is not empty and no recording"):
        learn("run", record=tmp_path)
    assert [path.name for path in tmp_path.iterdir()] == ["letter.txt"]
