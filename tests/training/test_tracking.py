"""What a training tells TensorBoard, Weights & Biases and MLflow."""

import sys
from types import ModuleType

import pytest
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from mimoc.base.errors import MimocError
from mimoc.training.tracking import ASKED_BY


class Recorded(ModuleType):
    def __init__(self, name):
        super().__init__(name)
        self.told, self.begun, self.ended = [], [], 0

    def init(self, **what):
        self.begun.append(what)
        return self

    def start_run(self, run_name):
        self.begun.append({"name": run_name})

    def log_params(self, params):
        self.begun[-1]["config"] = params

    def log(self, numbers, step):
        self.told.append((step, numbers))

    log_metrics = log

    def finish(self):
        self.ended += 1

    end_run = finish


@pytest.fixture(params=["wandb", "mlflow"])
def tracker(request, monkeypatch):
    found = Recorded(request.param)
    monkeypatch.setitem(sys.modules, request.param, found)
    return found


def test_tensorboard_shows_returns_and_losses_by_step(learn, tmp_path):
    learn("run")
    events = EventAccumulator(str(tmp_path / "run" / "tensorboard"))
    events.Reload()
    assert {"rollout/ep_rew_mean", "train/loss"} <= set(events.Tags()["scalars"])
    steps = [event.step for event in events.Scalars("train/loss")]
    assert steps == sorted(steps)
    assert steps[-1] <= 256


def test_another_tracker_is_told_if_its_variable_asks_for_it(learn, tracker, monkeypatch):
    monkeypatch.setenv(ASKED_BY[tracker.__name__], "file:infants")
    learn("run")
    (begun,) = tracker.begun
    assert (begun["name"], begun["config"]["algo"], tracker.ended) == ("run", "ppo", 1)
    assert [step for step, _ in tracker.told] == sorted(step for step, _ in tracker.told)
    assert all(isinstance(value, float) for _, numbers in tracker.told for value in numbers.values())


def test_no_tracker_is_told_without_its_variable(learn, tracker, monkeypatch):
    for name in ASKED_BY.values():
        monkeypatch.delenv(name, raising=False)
    learn("run", steps=128)
    assert (tracker.begun, tracker.told) == ([], [])


@pytest.fixture
def asked(tracker, monkeypatch):
    monkeypatch.setenv(ASKED_BY[tracker.__name__], "file:infants")
    return tracker


def test_a_tracker_that_cannot_begin_is_one_error(learn, asked, monkeypatch):
    def fail(**_):
        raise OSError("no\nlogin")

    monkeypatch.setattr(asked, "init", fail)
    monkeypatch.setattr(asked, "start_run", fail)
    with pytest.raises(MimocError, match=rf"^{asked.__name__} fails \(no login\); set it up, or unset "):
        learn("run", steps=128)


def test_a_tracker_that_fails_later_is_told_no_more_and_the_training_goes_on(learn, asked, monkeypatch):
    def fail(*_, **__):
        raise ConnectionError

    monkeypatch.setattr(asked, "log", fail)
    monkeypatch.setattr(asked, "log_metrics", fail)
    with pytest.warns(UserWarning, match=rf"^{asked.__name__} fails \(ConnectionError\) and is told no more"):
        learn("run")
    assert asked.ended == 0
