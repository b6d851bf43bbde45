"""What a training tells TensorBoard, Weights & Biases and MLflow."""

import sys
from types import ModuleType

import pytest
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator


class Recorded(ModuleType):
    """A tracker that keeps what it is told."""

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
    monkeypatch.setenv({"wandb": "WANDB_PROJECT", "mlflow": "MLFLOW_TRACKING_URI"}[tracker.__name__], "file:infants")
    learn("run")
    (begun,) = tracker.begun
    assert (begun["name"], begun["config"]["algo"], tracker.ended) == ("run", "ppo", 1)
    assert [step for step, _ in tracker.told] == sorted(step for step, _ in tracker.told)
    assert all(isinstance(value, float) for _, numbers in tracker.told for value in numbers.values())


def test_no_tracker_is_told_without_its_variable(learn, tracker, monkeypatch):
    for name in ("WANDB_PROJECT", "MLFLOW_TRACKING_URI"):
        monkeypatch.delenv(name, raising=False)
    learn("run", steps=128)
    assert (tracker.begun, tracker.told) == ([], [])
