"""The state of all infants on a device, to be saved and restored: every array that the next control step reads."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import torch
import warp as wp

from mimoc.base.state_form import check_form
from mimoc.runtime.device.arrays import put
from mimoc.runtime.device.initial_states import STATE, changed_rows
from mimoc.runtime.device.signals import DeviceSense, Line
from mimoc.runtime.device.simulation import DeviceSimulation

State = dict[str, np.ndarray]


def read_state(worlds: DeviceSimulation) -> State:
    """Return copies of all arrays, by name."""
    state = {name: tensor.cpu().numpy().copy() for name, tensor in _tensors(worlds).items()}
    return state | {name: array[:, rows].cpu().numpy().copy() for name, (array, rows) in _changed(worlds).items()}


def write_state(worlds: DeviceSimulation, state: Any) -> None:
    """Restore arrays, in the places in memory that they have.

    Raises:
        ValueError: If it is no state of such infants; nothing has changed then.
    """
    check_form(state, read_state(worlds))
    for name, tensor in _tensors(worlds).items():
        tensor.copy_(torch.from_numpy(state[name]))
    for name, (array, rows) in _changed(worlds).items():
        array[:, rows] = put(state[name]).to(array)
    worlds.arousal.set(worlds.arousal.level)


def _tensors(worlds: DeviceSimulation) -> dict[str, torch.Tensor]:
    """Return all arrays of physics, signals, noise, task and episodes by name, as they live on the device."""
    tensors = {f"data.{name}": wp.to_torch(getattr(worlds.data, name)) for name in (*STATE, "time")}
    tensors |= {f"task.{name}": values for name, values in worlds.task.memory.items()}
    tensors |= {f"observation.{name}": values for name, values in worlds.observation.items()}
    tensors |= _line("commands", worlds.commands) | _noise("commands", worlds.motor_noise)
    for name, sense in worlds.senses.items():
        tensors |= _of_sense(name, sense)
    ended, chance = worlds.ended, worlds.chance
    tensors |= {"steps": ended.steps, "episode": ended.episode, "ended": ended.ended, "clock": worlds.clock}
    return tensors | {"arousal": worlds.arousal.level, "seeds": chance.seeds, "draws": chance.steps}


def _changed(worlds: DeviceSimulation) -> Mapping[str, tuple[torch.Tensor, Any]]:
    """Return the arrays of the model that episodes change, and which of their rows."""
    rows = changed_rows(worlds.infants[0])
    return {f"model.{name}": (wp.to_torch(getattr(worlds.model, name)), put(which)) for name, which in rows.items()}


def _of_sense(name: str, sense: DeviceSense) -> dict[str, torch.Tensor]:
    return _line(name, sense.line) | _noise(name, sense.noise)


def _line(name: str, line: Line) -> dict[str, torch.Tensor]:
    rings = {f"{name}.ring.{number}": part.ring for number, part in enumerate(line.parts)}
    return {f"{name}.arrived": line.arrived, **rings}


def _noise(name: str, noise: Any) -> dict[str, torch.Tensor]:
    return {f"{name}.noise": noise.state} if noise is not None and noise.state is not None else {}
