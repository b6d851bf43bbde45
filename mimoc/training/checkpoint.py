"""Checkpoints: everything needed to resume a training run, in one file."""

import io
import json
import zipfile
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any

import numpy as np
import torch

from mimoc.base.errors import TrainingError
from mimoc.bundle.io import pack_arrays, unpack_arrays
from mimoc.bundle.regular_files import parse_json
from mimoc.policies.policy_file import DAMAGED, Archive
from mimoc.schema.base import Model
from mimoc.schema.quantities import Count, NotNegative
from mimoc.training.curve import Curve, CurvePoint

STATE, CURVE = "state.json", "curve.csv"
OF_TORCH = "policy.pth"  # Weights that PyTorch pickled, in policies for Stable-Baselines3 and in checkpoints of old.

UNUSABLE = "checkpoint is damaged; training cannot resume; start over with --force"
OUTDATED = "checkpoint was saved by an earlier version of mimoc; training cannot resume; start over with --force"

Arrays = Mapping[str, np.ndarray]
Modules = Mapping[str, Any]  # Networks and optimisers of PyTorch by name.


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of a training run."""

    steps: int = 0
    wall_s: float = 0.0
    curve: Curve = field(default_factory=Curve)


class IntervalCurve:
    """The rows of a learning curve that a training interval adds to those of earlier intervals."""

    def __init__(self, before: Progress, on_row: Callable[[CurvePoint], None]):
        """Continue a curve; *on_row* gets each new row."""
        self.row_start = before.steps
        """Control steps at the end of the last row."""
        self._before, self._on_row = before, on_row
        self._rows, self._start_s = list[CurvePoint](), perf_counter()

    def wall_s(self) -> float:
        """Return the wall time of the training so far."""
        return round(self._before.wall_s + perf_counter() - self._start_s, 3)

    def add(self, row: CurvePoint) -> None:
        """Add a row."""
        self._rows.append(row)
        self.row_start = row.steps
        self._on_row(row)

    def progress(self, steps: int) -> Progress:
        """Return the progress after so many control steps."""
        return Progress(steps, self.wall_s(), Curve((*self._before.curve.rows, *self._rows)))


class _State(Model):
    """What `state.json` contains."""

    steps: Count
    wall_s: NotNegative


def pack(progress: Progress, arrays: Mapping[str, Arrays]) -> bytes:
    """Return the content of a checkpoint file: progress, and arrays by name, in files of these names."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        archive.writestr(STATE, json.dumps({"steps": progress.steps, "wall_s": progress.wall_s}))
        archive.writestr(CURVE, progress.curve.to_csv(), zipfile.ZIP_DEFLATED)
        for name, of_file in arrays.items():
            archive.writestr(name, pack_arrays(of_file))
    return content.getvalue()


class Checkpoint(Archive):
    """The content of a checkpoint file."""

    def progress(self) -> Progress:
        """Return the progress at the checkpoint."""
        state = parse_json(self.content(STATE), _State)
        return Progress(state.steps, state.wall_s, Curve.from_csv(self.content(CURVE).decode()))

    def arrays(self, name: str) -> dict[str, np.ndarray]:
        """Return the arrays in one of its files."""
        return unpack_arrays(self.content(name))


@contextmanager
def opened_checkpoint(content: bytes) -> Iterator[Checkpoint]:
    """Open a checkpoint file; whatever cannot be read or restored from it is a TrainingError."""
    try:
        checkpoint = Checkpoint(content)
        if OF_TORCH not in checkpoint.namelist():
            yield checkpoint
            return
    except DAMAGED:
        raise TrainingError(UNUSABLE) from None
    raise TrainingError(OUTDATED)


def read_progress(content: bytes) -> Progress:
    """Return the progress stored in a checkpoint file, or raise a TrainingError if the file is damaged."""
    with opened_checkpoint(content) as checkpoint:
        return checkpoint.progress()


def weights_of(module: torch.nn.Module) -> dict[str, np.ndarray]:
    """Return the weights of a network, by their names in it."""
    return {name: tensor.numpy(force=True) for name, tensor in module.state_dict().items()}


def set_weights(module: torch.nn.Module, weights: Arrays) -> None:
    """Set the weights of a network, or raise a RuntimeError if they are those of another one."""
    module.load_state_dict({name: torch.from_numpy(array.copy()) for name, array in weights.items()})


ADAM = ("step", "exp_avg", "exp_avg_sq")  # What PyTorch's Adam, which all agents learn with, knows of a parameter.


def state_of(modules: Modules) -> dict[str, np.ndarray]:
    """Return the weights of networks and the states of optimisers.

    Names are those of weights (`policy/log_std`), and of what an optimiser knows of a parameter, by its number
    (`policy.optimizer/0/exp_avg`).
    """
    state = dict[str, np.ndarray]()
    for name, module in modules.items():
        if isinstance(module, torch.optim.Optimizer):
            known = module.state_dict()["state"].items()
            state |= {f"{name}/{number}/{key}": part[key].numpy(force=True) for number, part in known for key in ADAM}
        else:
            state |= {f"{name}/{key}": array for key, array in weights_of(module).items()}
    return state


def restore_state(modules: Modules, state: Arrays) -> None:
    """Restore what `state_of` has returned; raise a Key-, Runtime- or ValueError if it is of other networks."""
    for name, module in modules.items():
        part = {key.removeprefix(f"{name}/"): array for key, array in state.items() if key.startswith(f"{name}/")}
        if isinstance(module, torch.optim.Optimizer):
            _restore_optimiser(module, part)
        else:
            set_weights(module, part)


def _restore_optimiser(optimiser: torch.optim.Optimizer, saved: Arrays) -> None:
    parameters = [parameter for group in optimiser.param_groups for parameter in group["params"]]
    known = {number: part for number, part in enumerate(parameters) if f"{number}/{ADAM[0]}" in saved}
    shapes = {f"{number}/{key}": () if key == "step" else part.shape for number, part in known.items() for key in ADAM}
    if shapes != {name: array.shape for name, array in saved.items()}:
        raise ValueError("an optimiser of other parameters")
    state = {number: {key: torch.from_numpy(saved[f"{number}/{key}"].copy()) for key in ADAM} for number in known}
    optimiser.load_state_dict({"state": state, "param_groups": optimiser.state_dict()["param_groups"]})
