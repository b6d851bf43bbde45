"""States of all worlds of a device: what their next steps depend on, as arrays of all or as one dictionary for each."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import torch

from mimoc.base.state_form import check_form, require
from mimoc.runtime.growing import SEED
from mimoc.runtime.infant import AGE

PHYSICS = (
    *("time", "qpos", "qvel", "act", "ctrl", "qacc_warmstart", "qfrc_applied", "xfrc_applied", "eq_active"),
    *("mocap_pos", "mocap_quat", "userdata", "cvel"),
)
"""Fields of a simulation that its next steps depend on; MuJoCo Warp's welds read `cvel` before it is computed anew."""
Path = tuple[str, ...]  # The names that lead to a part of a state.
Kept = dict[Path, torch.Tensor | None]  # The state of all worlds, shape (worlds, ...).
HISTORY = "signals", "sent"  # What the paths of histories of delay lines begin with.


class Slot(NamedTuple):
    """A part of the state of all worlds."""

    read: Callable[[], torch.Tensor | None]
    write: Callable[[Any], Any]


def in_place(array: torch.Tensor, rows: Any = ...) -> Slot:
    """Return the slot of an array that keeps its place, shape (worlds, ...), or of some of its rows."""

    def write(values: torch.Tensor) -> None:
        array[:, rows] = values

    return Slot(lambda: array[:, rows], write)


def attribute(owner: Any, name: str) -> Slot:
    """Return the slot of an attribute that holds an array, shape (worlds, ...), or None."""
    return Slot(lambda: getattr(owner, name), lambda values: setattr(owner, name, values))


def kept_in(slots: Mapping[Path, Slot]) -> Kept:
    """Return copies of all that is in some slots."""
    values = {path: slot.read() for path, slot in slots.items()}
    return {path: None if value is None else value.clone() for path, value in values.items()}


def write_to(slots: Mapping[Path, Slot], kept: Kept) -> None:
    """Write kept values to slots, which may be those of the same infants at other ages."""
    for path, slot in slots.items():
        if path in kept:
            slot.write(kept[path])


def states_of(kept: Kept) -> list[dict[str, Any]]:
    """Return the state of each world as nested dictionaries of NumPy's arrays and numbers."""
    count = next(len(values) for values in kept.values() if values is not None)
    states: list[dict[str, Any]] = [{} for _ in range(count)]
    for path, values in kept.items():
        rows = [None] * count if values is None else values.cpu().numpy()
        for state, row in zip(states, rows, strict=True):
            inner = state
            for name in path[:-1]:
                inner = inner.setdefault(name, {})
            inner[path[-1]] = row.item() if np.ndim(row) == 0 and row is not None else row
    return states


def check_states(states: Any, kept: Kept) -> None:
    """Check that there is one state for each world, of the same form as that of the first world."""
    valid = states_of({path: None if values is None else values[:1] for path, values in kept.items()})[0]
    count = next(len(values) for values in kept.values() if values is not None)
    if not isinstance(states, (list, tuple)) or len(states) != count:
        raise ValueError(f"expected a list of {count} states, one for each infant")
    form = {
        **valid,
        AGE: 0.0,
        SEED: 0,
        "signals": {name: valid["signals"][name] for name in valid["signals"] if name != HISTORY[1]},
    }
    for number, state in enumerate(states):
        where = f"states[{number}]"
        check_form(state, form, where)
        for signal, like in valid["signals"][HISTORY[1]].items():
            place = f"{where}.{'.'.join(HISTORY)}.{signal}"
            sent = _at(state, (*HISTORY, signal))
            require(isinstance(sent, np.ndarray) and sent.ndim == like.ndim and len(sent) > 0, place, sent)
            check_form(sent, like[[0] * len(sent)], place)


def joined(states: Sequence[Mapping[str, Any]], kept: Kept) -> Kept:
    """Join the states of all worlds into arrays like those kept; histories are padded to the longest."""
    return {path: None if like is None else _joined(states, path, like) for path, like in kept.items()}


def _joined(states: Sequence[Mapping[str, Any]], path: Path, like: torch.Tensor) -> torch.Tensor:
    rows = [_at(state, path) for state in states]
    if path[:-1] == HISTORY:
        longest = max(map(len, rows))
        rows = [row[np.minimum(np.arange(longest), len(row) - 1)] for row in rows]
    return torch.as_tensor(np.stack(rows)).to(like)


def _at(state: Any, path: Path) -> Any:
    for name in path:
        state = state.get(name) if isinstance(state, Mapping) else None
    return state


def nested(slots: Mapping[str, Slot], *path: str) -> Iterator[tuple[Path, Slot]]:
    """Prefix the names of slots with a path."""
    for name, slot in slots.items():
        yield (*path, name), slot
