"""Recordings that are changed by chance: their tables, videos, sidecars and descriptions, and the bundle inside."""

import json
from pathlib import Path
from shutil import copytree

import numpy as np
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import changed_bytes, changed_data, pick
from fuzz.strange_infants import honest_bundle

import mimoc


def prepare(folder: Path) -> Path:
    """Return the folder of a recording of two episodes: one that is whole, and one in parts."""
    env = mimoc.make(honest_bundle(0))
    recorder = mimoc.Recorder(env, folder / "recording")
    recorder.action_space.seed(0)
    for _ in range(2):
        recorder.reset(seed=0)
        for _ in range(4):
            recorder.step(recorder.action_space.sample())
    recorder.close()
    return folder / "recording"


def attempt(prepared: Path, generator: np.random.Generator, folder: Path) -> None:
    """Change a file of it, and use all of it."""
    place = folder / "recording"
    copytree(prepared, place)
    files = [path for path in sorted(place.rglob("*")) if path.is_file() and "bundles" not in path.parts]
    path = pick(generator, files)
    if path.suffix == ".json" and generator.random() < 0.8:
        data = changed_data(generator, json.loads(path.read_bytes()))
        path.write_bytes(json.dumps(data).encode(errors="surrogateescape"))
    elif generator.random() < 0.1:
        path.write_bytes(pick(generator, files).read_bytes())
    else:
        path.write_bytes(changed_bytes(generator, path.read_bytes()))
    use(place, generator)


def use(place: Path, generator: np.random.Generator) -> None:
    """Read all that is in a recording, and now and then simulate it again."""
    recording = mimoc.read_recording(place)
    recording.summary()
    for episode in recording:
        _ = episode.observations, episode.states, episode.changes, episode.start, episode.options, episode.before
        _ = episode.actions, episode.infos, episode.reward_terms, episode.time_s, episode.columns()
    recording.bundle()
    if generator.random() < 0.3:
        list(map(str, mimoc.replay_recording(recording)))


FUZZER = Fuzzer(
    name="recordings",
    about="recordings, changed in tables, videos, sidecars and descriptions, read and simulated again",
    prepare=prepare,
    attempt=attempt,
    short=10,
)
