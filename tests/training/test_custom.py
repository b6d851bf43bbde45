"""Trainings with rewards and senses that a script passes as objects, or a user names on the command line."""

import sys

import numpy as np
import pytest
from gymnasium.spaces import Box

import mimoc
from mimoc import cli
from mimoc.base.errors import TrainingError
from mimoc.training.evaluation import load_policy

MODULE = """
class Stillness:
    steps = 20

    def judge(self, data, action, effort):
        return -float((data.qvel**2).sum())


class Demanding:
    def __init__(self, limit):
        pass
"""


class Count:
    """Rewards that grow within an episode: each environment must have a counter of its own."""

    steps = 8

    def start(self, data, generator):
        self.state = {"count": 0}

    def judge(self, data, action, effort):
        self.state = {"count": self.state["count"] + 1}
        return float(self.state["count"])


class Clock:
    space = Box(0.0, 10.0, (1,), np.float32)

    def __call__(self, data):
        return [data.time]


def test_each_environment_has_a_task_of_its_own(learn):
    training = learn(task=Count())
    assert {row.episode_return for row in training.curve.rows if row.episodes} == {36.0}


def test_a_policy_learns_from_a_sense_that_is_passed(learn, bundle):
    training = learn(senses={"clock": Clock()}, task=Count())
    env = mimoc.make(bundle, senses={"clock": Clock()}, task=Count())
    (episode,) = mimoc.evaluate(env, load_policy(training.policy), episodes=1)
    assert (episode.steps, episode.total_reward) == (8, 36.0)


def test_a_run_is_only_resumed_with_the_same_task(learn):
    learn(task=Count())
    with pytest.raises(
        TrainingError, match=r"started with steps_per_episode 8, not 30; task .*test_custom:Count, not unset"
    ):
        learn(steps=512)
    assert learn(steps=384, task=Count()).resumed_at == 256


@pytest.fixture
def invoke(monkeypatch, capfd, tmp_path, bundle):
    """Return what runs `mimoc train` in a folder with a module of tasks."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tasks_of_a_test.py").write_text(MODULE)
    mimoc.write_bundle(bundle, "out")

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["mimoc", "train", "out", "-o", "run", *arguments])
        try:
            cli.main()
        except SystemExit as exit_:
            return exit_.code or 0, capfd.readouterr().err
        return 0, capfd.readouterr().err

    yield run
    sys.modules.pop("tasks_of_a_test", None)


SMALL = ["--steps", "64", "--envs", "2", "--one-process", "--set", "n_steps=32", "--set", "batch_size=64"]


def test_a_task_can_be_named_on_the_command_line(invoke, tmp_path):
    assert invoke("--task", "tasks_of_a_test:Stillness", *SMALL)[0] == 0
    assert "--task tasks_of_a_test:Stillness" in (tmp_path / "run" / "run.json").read_text()


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("tasks_of_a_test", "'tasks_of_a_test' does not name a class; write MODULE:CLASS, such as my_task:Stillness"),
        ("your_tasks:Stillness", "No module named 'your_tasks'; run this command in the folder of the module"),
        ("tasks_of_a_test:Swiftness", "the module has no class 'Swiftness'"),
        ("tasks_of_a_test:Demanding", "give all its arguments defaults"),
    ],
)
def test_a_task_that_is_not_there_is_a_clear_error(name, message, invoke, tmp_path):
    code, said = invoke("--task", name, *SMALL)
    assert (code, "Traceback" in said) == (2, False)
    assert message in said
    assert not (tmp_path / "run").exists()
