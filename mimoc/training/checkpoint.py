"""Checkpoints: everything needed to resume a training run, in one file."""

import io
import json
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field

import numpy as np
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.buffers import DictReplayBuffer
from stable_baselines3.common.vec_env import VecNormalize

from mimoc.base.errors import TrainingError
from mimoc.bundle.arrays import pack_arrays, unpack_arrays
from mimoc.bundle.regular_files import parse_json
from mimoc.policies.policy_file import DAMAGED, WEIGHTS, Archive
from mimoc.schema.base import Model
from mimoc.schema.quantities import Count, NotNegative
from mimoc.training.agents import OF_TORCH, SCALE, Modules, agent_state, restore_agent, restore_state, state_of
from mimoc.training.curve import Curve
from mimoc.training.vector_env import set_statistics, statistics

STATE, CURVE, REPLAY = "state.json", "curve.csv", "replay.npz"
_VECTORS = ("actions", "rewards", "dones", "timeouts")
_DICTIONARIES = ("observations", "next_observations")

UNUSABLE = "checkpoint is damaged; training cannot resume; start over with --force"
OUTDATED = "checkpoint was saved by an earlier version of mimoc; training cannot resume; start over with --force"


@dataclass(frozen=True, slots=True)
class Progress:
    """Progress of a training run."""

    steps: int = 0
    wall_s: float = 0.0
    curve: Curve = field(default_factory=Curve)


class _State(Model):
    """What `state.json` contains."""

    steps: Count
    wall_s: NotNegative


def pack(agent: BaseAlgorithm, env: VecNormalize, progress: Progress) -> bytes:
    """Return the content of a checkpoint file: all that an agent has learnt, statistics, replay buffer and progress."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        _pack_progress(archive, progress)
        archive.writestr(WEIGHTS, pack_arrays(agent_state(agent)))
        archive.writestr(SCALE, pack_arrays(statistics(env)), zipfile.ZIP_DEFLATED)
        if isinstance(buffer := getattr(agent, "replay_buffer", None), DictReplayBuffer):
            used = buffer.buffer_size if buffer.full else buffer.pos
            arrays = {name: getattr(buffer, name)[:used] for name in _VECTORS}
            for kind in _DICTIONARIES:
                arrays |= {f"{kind}.{name}": part[:used] for name, part in getattr(buffer, kind).items()}
            archive.writestr(
                REPLAY, pack_arrays({"pos": np.array(buffer.pos), "full": np.array(buffer.full), **arrays})
            )
    return content.getvalue()


def restore(content: bytes, agent: BaseAlgorithm, env: VecNormalize) -> Progress:
    """Restore an agent and its environment from a checkpoint file; return the progress at that point."""
    with _opened(content) as archive:
        progress = _progress(archive)
        restore_agent(agent, unpack_arrays(archive.content(WEIGHTS)))
        set_statistics(env, unpack_arrays(archive.content(SCALE)))
        agent.num_timesteps = progress.steps
        if isinstance(buffer := getattr(agent, "replay_buffer", None), DictReplayBuffer):
            saved = unpack_arrays(archive.content(REPLAY))
            used, position, full = len(saved["rewards"]), int(saved["pos"]), bool(saved["full"])
            if used != (buffer.buffer_size if full else position) or not 0 <= position < buffer.buffer_size:
                raise ValueError("a replay buffer of another size")
            for name in _VECTORS:
                getattr(buffer, name)[:used] = saved[name]
            for kind in _DICTIONARIES:
                for name, part in getattr(buffer, kind).items():
                    part[:used] = saved[f"{kind}.{name}"]
            buffer.pos, buffer.full = position, full
    return progress


def pack_modules(modules: Modules, progress: Progress) -> bytes:
    """Return the content of a checkpoint file of networks with their statistics, optimisers and progress."""
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        _pack_progress(archive, progress)
        archive.writestr(WEIGHTS, pack_arrays(state_of(modules)))
    return content.getvalue()


def restore_modules(content: bytes, modules: Modules) -> Progress:
    """Restore what `pack_modules` has packed; return the progress at that point."""
    with _opened(content) as archive:
        restore_state(modules, unpack_arrays(archive.content(WEIGHTS)))
        return _progress(archive)


def read_progress(content: bytes) -> Progress:
    """Return the progress stored in a checkpoint file, or raise a TrainingError if the file is damaged."""
    with _opened(content) as archive:
        return _progress(archive)


@contextmanager
def _opened(content: bytes) -> Iterator[Archive]:
    try:
        archive = Archive(content)
        if OF_TORCH not in archive.namelist():
            yield archive
            return
    except DAMAGED:
        raise TrainingError(UNUSABLE) from None
    raise TrainingError(OUTDATED)


def _pack_progress(archive: zipfile.ZipFile, progress: Progress) -> None:
    archive.writestr(STATE, json.dumps({"steps": progress.steps, "wall_s": progress.wall_s}))
    archive.writestr(CURVE, progress.curve.to_csv(), zipfile.ZIP_DEFLATED)


def _progress(archive: Archive) -> Progress:
    state = parse_json(archive.content(STATE), _State)
    return Progress(state.steps, state.wall_s, Curve.from_csv(archive.content(CURVE).decode()))
