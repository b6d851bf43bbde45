"""All that a training goes on from, as one file that is whole or is not there."""

import io
import json
import zipfile
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.buffers import DictReplayBuffer
from stable_baselines3.common.vec_env import VecNormalize

from mimoc.errors import TrainingError
from mimoc.training.agents import set_weights
from mimoc.training.curve import Curve
from mimoc.training.policies import DAMAGED, SCALE, read_tensors
from mimoc.training.worlds import set_statistics

STATE, CURVE, REPLAY = "state.json", "curve.csv", "replay.npz"
_VECTORS = ("actions", "rewards", "dones", "timeouts")
_DICTIONARIES = ("observations", "next_observations")


@dataclass(frozen=True, slots=True)
class Progress:
    """How far a training has come."""

    steps: int = 0
    """Control steps trained for, those of all infants together."""
    wall_s: float = 0.0
    """Time that took."""
    curve: Curve = field(default_factory=Curve)


def pack(policy: bytes, agent: BaseAlgorithm, progress: Progress) -> bytes:
    """Return the file of a training.

    Args:
        policy: What `pack_policy` made of the agent; optimisers and statistics are in it.
        agent: The agent, for what it remembers besides.
        progress: How far it has come.
    """
    content = io.BytesIO(policy)
    with zipfile.ZipFile(content, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(STATE, json.dumps({"steps": progress.steps, "wall_s": progress.wall_s}))
        archive.writestr(CURVE, progress.curve.to_csv())
        if isinstance(memory := getattr(agent, "replay_buffer", None), DictReplayBuffer):
            archive.writestr(REPLAY, _pack_memory(memory), zipfile.ZIP_STORED)
    return content.getvalue()


def unpack(content: bytes, agent: BaseAlgorithm, world: VecNormalize) -> Progress:
    """Bring an agent and its world to where they were; return how far that is.

    Raises:
        TrainingError: If the file is damaged, or of another agent.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            progress = _progress(archive)
            set_weights(agent, {name[: -len(".pth")]: _tensors(archive, name) for name in _weights(archive)})
            set_statistics(world, _arrays(archive.read(SCALE)))
            agent.num_timesteps = progress.steps
            if isinstance(memory := getattr(agent, "replay_buffer", None), DictReplayBuffer):
                _unpack_memory(memory, _arrays(archive.read(REPLAY)))
    except DAMAGED:
        raise TrainingError("it cannot be gone on from, it is damaged; begin anew with --force") from None
    return progress


def read_progress(content: bytes) -> Progress:
    """Return how far a training has come.

    Raises:
        TrainingError: If the file is damaged.
    """
    try:
        with zipfile.ZipFile(io.BytesIO(content)) as archive:
            return _progress(archive)
    except DAMAGED:
        raise TrainingError("it cannot be gone on from, it is damaged; begin anew with --force") from None


def _progress(archive: zipfile.ZipFile) -> Progress:
    state = json.loads(archive.read(STATE))
    return Progress(state["steps"], state["wall_s"], Curve.from_csv(archive.read(CURVE).decode()))


def _weights(archive: zipfile.ZipFile) -> list[str]:
    return [name for name in archive.namelist() if name.endswith(".pth")]


def _tensors(archive: zipfile.ZipFile, name: str) -> Any:
    return read_tensors(archive.read(name)) or {}


def _arrays(content: bytes) -> dict[str, np.ndarray]:
    with np.load(io.BytesIO(content), allow_pickle=False) as file:
        return dict(file)


def _pack_memory(memory: DictReplayBuffer) -> bytes:
    """Return what an agent remembers of its past steps; room that is not used yet is left out."""
    used, content = memory.buffer_size if memory.full else memory.pos, io.BytesIO()
    arrays: dict[str, Any] = {name: getattr(memory, name)[:used] for name in _VECTORS}
    for kind in _DICTIONARIES:
        arrays |= {f"{kind}.{name}": part[:used] for name, part in getattr(memory, kind).items()}
    np.savez(content, pos=memory.pos, full=memory.full, **arrays)
    return content.getvalue()


def _unpack_memory(memory: DictReplayBuffer, known: dict[str, np.ndarray]) -> None:
    used = len(known["rewards"])
    for name in _VECTORS:
        getattr(memory, name)[:used] = known[name]
    for kind in _DICTIONARIES:
        for name, part in getattr(memory, kind).items():
            part[:used] = known[f"{kind}.{name}"]
    memory.pos, memory.full = int(known["pos"]), bool(known["full"])
