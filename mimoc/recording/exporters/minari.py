"""A recording as a data set of Minari, which it writes itself."""

import copy
import json
import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from gymnasium.envs.registration import EnvSpec

from mimoc.base.errors import MissingExtraError, counted
from mimoc.bundle.io import Bundle
from mimoc.recording.columns import Reading
from mimoc.recording.reading import Episode, ReadRecording
from mimoc.runtime.actuation import command_range
from mimoc.schema import source

INFANT, RESOLVED = "mimoc/Infant-v0", "resolved.yaml"
"""The environment of any infant, and the file of a bundle that holds its whole spec."""
HOME = "MINARI_DATASETS_PATH"  # Environment variable that says where Minari's data sets are.


def export(recording: ReadRecording, out: Path, progress: Callable[[int, int], None]) -> list[str]:
    """Write the data set `mimoc/<name>-v0`; with this folder as MINARI_DATASETS_PATH, Minari loads it by this name."""
    try:
        import minari
        from minari.data_collector import EpisodeBuffer
    except ImportError:
        raise MissingExtraError("minari", "minari") from None
    bundle = recording.bundle()
    name = f"mimoc/{recording.whole_bundle().manifest.name}-v0"
    low, high = (bound.astype(np.float32) for bound in command_range(bundle.manifest.actuation))
    readings = recording[0].described.readings

    def buffers() -> Iterator[EpisodeBuffer]:
        for number, episode in enumerate(recording):
            progress(number, len(recording))
            yield EpisodeBuffer(id=number, **_buffer(episode))

    versions = recording[-1].versions
    texts = recording[0].described.movement_names
    with _datasets_in(out), warnings.catch_warnings():
        warnings.simplefilter("ignore")  # It misses an author and a link to the code, which are the user's to give.
        minari.create_dataset_from_buffers(
            dataset_id=name,
            buffer=buffers(),  # pyright: ignore[reportArgumentType] - Any iterable will do, one episode at a time.
            observation_space=spaces.Dict({reading.name: _space(reading) for reading in readings}),
            action_space=spaces.Box(low, high, dtype=np.float32),
            env=_Recorded(env_spec_of(bundle)),
            data_format="parquet",
            jpeg_encoding=False,
            description=f"Recorded with mimoc {versions.get('mimoc', '')} and MuJoCo {versions.get('mujoco', '')}",
        )
    cut = sum(not (episode.terminated[-1] or episode.truncated[-1]) for episode in recording)
    return [
        f"load it with MINARI_DATASETS_PATH set to this folder: minari.load_dataset('{name}')",
        *([f"{counted(cut, 'episode')} cut short: marked as truncated"] if cut else []),
        *(["movement columns of texts are left out: what is touched or looked at"] if texts else []),
        *_notes_on_environment(recording, bundle),
        "names, units and states are left out: Minari has no place for them",
    ]


class _Recorded(gymnasium.Env[Any, Any]):
    """What Minari reads of the environment that was recorded: how it is made again."""

    def __init__(self, spec: EnvSpec | None):
        self.spec = spec


def env_spec_of(bundle: Bundle) -> EnvSpec | None:
    """Return how Gymnasium makes the environment of a bundle again, from its spec; None if it has none, or no model.

    All of it is JSON: the keys of the spec stand for the bundle.
    """
    if RESOLVED not in bundle.files or bundle.manifest.prefix:
        return None
    data = source.parse(bundle.files[RESOLVED], RESOLVED).data
    data["scene"] = {**data.get("scene", {}), "seed": bundle.manifest.seed}
    spec = copy.deepcopy(gymnasium.spec(INFANT))
    spec.kwargs = {"bundle": json.loads(json.dumps(data))}
    return spec


def _notes_on_environment(recording: ReadRecording, bundle: Bundle) -> Iterator[str]:
    if bundle.manifest.prefix:
        yield "these infants share a world, whose environment Minari cannot recover"
    elif RESOLVED not in bundle.files:
        yield "the bundle does not contain its spec, so that Minari cannot recover the environment"
    for what, name in recording[0].objects.items():
        yield f"{what} is an object of a script's own ({name}), which Minari cannot recover"


def _buffer(episode: Episode) -> dict[str, Any]:
    truncated = episode.truncated.copy()
    truncated[-1] |= not episode.terminated[-1]
    numbers = {name: episode.column(name) for name in episode.table.column_names if name.startswith(("info.", "term."))}
    numbers |= {f"movement.{name}": episode.movement[name] for name in episode.described.movement}
    return {
        "seed": episode.seed,
        "options": dict(episode.options) or None,
        "observations": dict(episode.observations),
        "actions": episode.actions.astype(np.float32),
        "rewards": episode.rewards,
        "terminations": episode.terminated,
        "truncations": truncated,
        "infos": {name.removeprefix("info."): values.tolist() for name, values in numbers.items()},
    }


def _space(reading: Reading) -> spaces.Box:
    kind = np.dtype(reading.dtype)
    if kind.kind == "f":
        return spaces.Box(-np.inf, np.inf, reading.shape, kind.type)
    limits = (0, 1) if kind.kind == "b" else (np.iinfo(kind).min, np.iinfo(kind).max)
    return spaces.Box(*limits, reading.shape, kind.type)


@contextmanager
def _datasets_in(folder: Path) -> Iterator[None]:
    before = {name: value for name, value in os.environ.items() if name == HOME}
    os.environ[HOME] = str(folder)
    try:
        yield
    finally:
        del os.environ[HOME]
        os.environ.update(before)
