"""Where the progress of a training goes: TensorBoard and, if asked for, Weights & Biases and MLflow; warnings."""

import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy.typing as npt
from stable_baselines3.common.logger import KVWriter, Logger

from mimoc.base.errors import MimocError
from mimoc.bundle.files import check_unlinked, make_folder

TENSORBOARD = "tensorboard"  # Folder of a training run with TensorBoard's files.
ASKED_BY = {"wandb": "WANDB_PROJECT", "mlflow": "MLFLOW_TRACKING_URI"}
"""The variable of each of the other trackers, which asks for it: nothing is sent anywhere without it."""


@contextmanager
def tracked(folder: Path, settings: Mapping[str, Any], steps: int) -> Iterator[Logger]:
    """Open all trackers of a training that goes on after some steps, or raise a MimocError if one cannot begin."""
    with ExitStack() as opened:
        writers = list[KVWriter]()
        for writer in _writers(folder, settings, steps):
            opened.callback(writer.close)
            writers.append(writer)
        yield Logger(str(folder), writers)


def _writers(folder: Path, settings: Mapping[str, Any], steps: int) -> Iterator[KVWriter]:
    with suppress(ImportError):  # An installation from before it was part of `mimoc[train]`.
        yield _tensorboard(make_folder(folder / TENSORBOARD, below=folder), steps)
    for name, begin in {"wandb": _wandb, "mlflow": _mlflow}.items():
        if ASKED_BY[name] in os.environ:
            with suppress(ImportError):
                yield _remote(name, partial(begin, import_module(name), folder, settings))


class _Writer(KVWriter):
    """A tracker that gets numbers by step; if one that may be far away fails, it gets no more, and training goes on."""

    def __init__(self, write: Callable[[dict[str, float], int], None], end: Callable[[], None], remote: str = ""):
        """Begin with functions that keep the numbers of a step and end the run; *remote* names one that is far away."""
        self._write, self._end, self._remote, self._works = write, end, remote, True

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        numbers = {name: float(value) for name, value in key_values.items() if hasattr(value, "__float__")}
        self._try(partial(self._write, numbers, step))

    def close(self) -> None:
        self._try(self._end)

    def _try(self, call: Callable[[], None]) -> None:
        if self._works:
            try:
                call()
            except Exception as error:  # Each tracker fails with errors of its own.
                if not self._remote:
                    raise
                self._works = False
                message = f"{self._remote} fails ({_line(error)}) and is told no more of this training"
                warnings.warn(message, stacklevel=2)


def _tensorboard(folder: Path, steps: int) -> _Writer:
    """Return TensorBoard's; what was written after the checkpoint that a run is resumed from is dropped."""
    import tensorboard  # noqa: F401 - What is imported next needs it.
    from torch.utils.tensorboard import SummaryWriter

    events = SummaryWriter(str(folder), purge_step=steps)

    def write(numbers: dict[str, float], step: int) -> None:
        for name, value in numbers.items():
            events.add_scalar(name, value, step)
        events.flush()

    return _Writer(write, events.close)


def _remote(name: str, begin: Callable[[], tuple[Callable[..., Any], Callable[..., Any]]]) -> _Writer:
    """Return a tracker that may be far away, or raise a MimocError if it cannot begin."""
    try:
        write, end = begin()
    except Exception as error:  # Each tracker fails with errors of its own.
        advice = f"set it up, or unset {ASKED_BY[name]} to train without"
        raise MimocError(f"{name} fails ({_line(error)}); {advice}") from None
    return _Writer(lambda numbers, step: write(numbers, step=step), end, name)


def _wandb(wandb: Any, folder: Path, settings: Mapping[str, Any]) -> tuple[Callable[..., Any], Callable[..., Any]]:
    check_unlinked(folder / "wandb", below=folder)  # Where it writes.
    run = wandb.init(dir=str(folder), name=folder.name, config=dict(settings))
    return run.log, run.finish


def _mlflow(mlflow: Any, folder: Path, settings: Mapping[str, Any]) -> tuple[Callable[..., Any], Callable[..., Any]]:
    mlflow.start_run(run_name=folder.name)
    mlflow.log_params(dict(settings))
    return mlflow.log_metrics, mlflow.end_run


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:200] or type(error).__name__


ROW_STEPS = 4096  # Control steps per row of a learning curve; the last row of an interval may cover fewer.
CONSTANT_STEPS = 1000
"""Control steps, summed over all environments, after which a reward that has not changed is a warning."""


class RewardWatch:
    """Warns, once, if the rewards of a training do not change."""

    def __init__(self) -> None:
        self._first: float | None = None
        self._steps = 0
        self.ended = False
        """Whether there is nothing left to find out."""

    def __call__(self, rewards: npt.NDArray[Any]) -> None:
        """Look at the rewards of a control step, shape (environments,)."""
        self._first = float(rewards[0]) if self._first is None else self._first
        self._steps += len(rewards)
        changes = bool((rewards != self._first).any())
        self.ended = changes or self._steps >= CONSTANT_STEPS
        if self.ended and not changes:
            warnings.warn(
                f"the reward of all {self._steps:,} control steps so far is {self._first:g}: unless it changes, nothing"
                " can be learnt from it; give the spec a task, or train with a task of your own",
                RuntimeWarning,
                stacklevel=2,
            )
