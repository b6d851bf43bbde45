"""Where else the progress of a training goes: TensorBoard and, if asked for, Weights & Biases and MLflow."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any

from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.logger import KVWriter, Logger

TENSORBOARD = "tensorboard"
"""Folder of a training run with TensorBoard's files."""
ASKED_BY = {"wandb": "WANDB_PROJECT", "mlflow": "MLFLOW_TRACKING_URI"}
"""The variable of each of the other trackers, which asks for it: nothing is sent anywhere without it."""


@contextmanager
def tracked(agent: BaseAlgorithm, folder: Path, settings: Mapping[str, Any]) -> Iterator[None]:
    """Let an agent tell its trackers what Stable-Baselines3 logs: returns, losses, speed.

    Args:
        agent: The agent, at the step that it goes on from.
        folder: Folder of the training run.
        settings: What the run is told apart by, for trackers that keep it.
    """
    writers = [*_writers(agent, folder, settings)]
    agent.set_logger(Logger(str(folder), writers))
    try:
        yield
    finally:
        for writer in writers:
            writer.close()


def _writers(agent: BaseAlgorithm, folder: Path, settings: Mapping[str, Any]) -> Iterator[KVWriter]:
    with suppress(ImportError):  # An installation from before it was part of `mimoc[train]`.
        yield _TensorBoard(folder / TENSORBOARD, agent.num_timesteps)
    for name, made in {"wandb": _Wandb, "mlflow": _Mlflow}.items():
        if ASKED_BY[name] in os.environ:
            with suppress(ImportError):
                yield made(import_module(name), folder, settings)


class _TensorBoard(KVWriter):
    """Event files; what was written after the checkpoint that a run is resumed from is dropped."""

    def __init__(self, folder: Path, steps: int):
        """Open a file."""
        import tensorboard  # noqa: F401 - What is imported next needs it.
        from torch.utils.tensorboard import SummaryWriter

        self._writer = SummaryWriter(str(folder), purge_step=steps)

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        """Write numbers."""
        for name, value in _numbers(key_values).items():
            self._writer.add_scalar(name, value, step)
        self._writer.flush()

    def close(self) -> None:
        """Close the file."""
        self._writer.close()


class _Wandb(KVWriter):
    """A run of Weights & Biases, in the project that its variable names."""

    def __init__(self, wandb: Any, folder: Path, settings: Mapping[str, Any]):
        """Begin a run."""
        self._run = wandb.init(dir=str(folder), name=folder.name, config=dict(settings))

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        """Send numbers."""
        self._run.log(_numbers(key_values), step=step)

    def close(self) -> None:
        """End the run."""
        self._run.finish()


class _Mlflow(KVWriter):
    """A run of MLflow, at the place that its variable names."""

    def __init__(self, mlflow: Any, folder: Path, settings: Mapping[str, Any]):
        """Begin a run."""
        self._mlflow = mlflow
        mlflow.start_run(run_name=folder.name)
        mlflow.log_params(dict(settings))

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        """Send numbers."""
        self._mlflow.log_metrics(_numbers(key_values), step=step)

    def close(self) -> None:
        """End the run."""
        self._mlflow.end_run()


def _numbers(key_values: Mapping[str, Any]) -> dict[str, float]:
    """Return what can be drawn as a curve."""
    return {name: float(value) for name, value in key_values.items() if hasattr(value, "__float__")}
