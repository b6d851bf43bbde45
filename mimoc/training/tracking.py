"""Where else the progress of a training goes: TensorBoard and, if asked for, Weights & Biases and MLflow."""

import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from importlib import import_module
from pathlib import Path
from typing import Any

from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.logger import KVWriter, Logger

from mimoc.bundle.files import check_unlinked, make_folder
from mimoc.errors import MimocError

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

    Raises:
        MimocError: If one of them cannot begin.
    """
    with ExitStack() as opened:
        writers = list[KVWriter]()
        for writer in _writers(agent, folder, settings):
            opened.callback(writer.close)
            writers.append(writer)
        agent.set_logger(Logger(str(folder), writers))
        yield


def _writers(agent: BaseAlgorithm, folder: Path, settings: Mapping[str, Any]) -> Iterator[KVWriter]:
    with suppress(ImportError):  # An installation from before it was part of `mimoc[train]`.
        yield _TensorBoard(make_folder(folder / TENSORBOARD, below=folder), agent.num_timesteps)
    for name, made in {"wandb": _Wandb, "mlflow": _Mlflow}.items():
        if ASKED_BY[name] in os.environ:
            with suppress(ImportError):
                module = import_module(name)
                yield _Remote(name, lambda made=made, module=module: made(module, folder, settings))


class _Remote(KVWriter):
    """A tracker that may be far away: if it fails later on, it is told no more, and the training goes on."""

    def __init__(self, name: str, made: Callable[[], KVWriter]):
        """Begin a run.

        Raises:
            MimocError: If that fails.
        """
        self._name, self._works = name, True
        try:
            self._writer = made()
        except Exception as error:  # Each tracker fails with errors of its own.
            variable = ASKED_BY[name]
            raise MimocError(
                f"{name} fails ({_line(error)}); set it up, or unset {variable} to train without"
            ) from None

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        """Send numbers."""
        self._try(lambda: self._writer.write(key_values, key_excluded, step))

    def close(self) -> None:
        """End the run."""
        self._try(self._writer.close)

    def _try(self, tell: Callable[[], None]) -> None:
        if self._works:
            try:
                tell()
            except Exception as error:
                self._works = False
                warnings.warn(f"{self._name} fails ({_line(error)}) and is told no more of this training", stacklevel=2)


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
        check_unlinked(folder / "wandb", below=folder)  # Where it writes.
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


def _line(error: Exception) -> str:
    """Return what an error says, in one line that is not too long."""
    return " ".join(str(error).split())[:200] or type(error).__name__


def _numbers(key_values: Mapping[str, Any]) -> dict[str, float]:
    """Return what can be drawn as a curve."""
    return {name: float(value) for name, value in key_values.items() if hasattr(value, "__float__")}
