"""Checkpoints: everything needed to resume a training run, in one file."""

import io
import json
import zipfile
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.buffers import DictReplayBuffer
from stable_baselines3.common.vec_env import VecNormalize

from mimoc.bundle.json_files import parse_json
from mimoc.bundle.regular_files import UnusableFileError
from mimoc.errors import TrainingError
from mimoc.schema.base import Model
from mimoc.schema.bounded import Count, NotNegative
from mimoc.training.agents import set_weights
from mimoc.training.archives import Archive, read_arrays
from mimoc.training.curve import Curve
from mimoc.training.policies import DAMAGED, SCALE
from mimoc.training.tensors import read_tensors
from mimoc.training.vector_env import set_statistics

STATE, CURVE, REPLAY = "state.json", "curve.csv", "replay.npz"
_VECTORS = ("actions", "rewards", "dones", "timeouts")
_DICTIONARIES = ("observations", "next_observations")


UNUSABLE = "checkpoint is damaged; training cannot resume; start over with --force"


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of a training run."""

    steps: int = 0
    """Control steps trained for, summed over all environments."""
    wall_s: float = 0.0
    """Wall time of the training so far."""
    curve: Curve = field(default_factory=Curve)


class _State(Model):
    """What `state.json` contains."""

    steps: Count
    wall_s: NotNegative


def pack(policy: bytes, agent: BaseAlgorithm, progress: Progress) -> bytes:
    """Return the content of a checkpoint file.

    Args:
        policy: The policy file from `pack_policy`, which includes optimisers and statistics.
        agent: The agent, for its replay buffer.
        progress: Progress of the training.
    """
    content = io.BytesIO(policy)
    with zipfile.ZipFile(content, "a", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(STATE, json.dumps({"steps": progress.steps, "wall_s": progress.wall_s}))
        archive.writestr(CURVE, progress.curve.to_csv())
        if isinstance(buffer := getattr(agent, "replay_buffer", None), DictReplayBuffer):
            archive.writestr(REPLAY, _pack_replay_buffer(buffer), zipfile.ZIP_STORED)
    return content.getvalue()


def restore(content: bytes, agent: BaseAlgorithm, env: VecNormalize) -> Progress:
    """Restore an agent and its environment from a checkpoint file; return the progress at that point.

    Raises:
        TrainingError: If the file is damaged or belongs to another agent.
    """
    try:
        archive = Archive(content)
        progress = _progress(archive)
        set_weights(agent, {name[: -len(".pth")]: _tensors(archive, name) for name in _weights(archive)})
        set_statistics(env, read_arrays(archive.read(SCALE)))
        agent.num_timesteps = progress.steps
        if isinstance(buffer := getattr(agent, "replay_buffer", None), DictReplayBuffer):
            _restore_replay_buffer(buffer, read_arrays(archive.read(REPLAY)))
    except (*DAMAGED, UnusableFileError):
        raise TrainingError(UNUSABLE) from None
    return progress


def read_progress(content: bytes) -> Progress:
    """Return the progress stored in a checkpoint file.

    Raises:
        TrainingError: If the file is damaged.
    """
    try:
        return _progress(Archive(content))
    except (*DAMAGED, UnusableFileError):
        raise TrainingError(UNUSABLE) from None


def _progress(archive: Archive) -> Progress:
    state = parse_json(archive.read(STATE), _State)
    return Progress(state.steps, state.wall_s, Curve.from_csv(archive.read(CURVE).decode()))


def _weights(archive: Archive) -> list[str]:
    return [name for name in archive.names() if name.endswith(".pth")]


def _tensors(archive: Archive, name: str) -> Any:
    return read_tensors(archive.read(name)) or {}


def _pack_replay_buffer(buffer: DictReplayBuffer) -> bytes:
    """Return the used part of a replay buffer as the content of an .npz file."""
    used, content = buffer.buffer_size if buffer.full else buffer.pos, io.BytesIO()
    arrays: dict[str, Any] = {name: getattr(buffer, name)[:used] for name in _VECTORS}
    for kind in _DICTIONARIES:
        arrays |= {f"{kind}.{name}": part[:used] for name, part in getattr(buffer, kind).items()}
    np.savez(content, pos=buffer.pos, full=buffer.full, **arrays)
    return content.getvalue()


def _restore_replay_buffer(buffer: DictReplayBuffer, saved: Mapping[str, np.ndarray]) -> None:
    used, position, full = len(saved["rewards"]), int(saved["pos"]), bool(saved["full"])
    if used != (buffer.buffer_size if full else position) or not 0 <= position < buffer.buffer_size:
        raise ValueError("a replay buffer of another size")
    for name in _VECTORS:
        getattr(buffer, name)[:used] = saved[name]
    for kind in _DICTIONARIES:
        for name, part in getattr(buffer, kind).items():
            part[:used] = saved[f"{kind}.{name}"]
    buffer.pos, buffer.full = position, full
