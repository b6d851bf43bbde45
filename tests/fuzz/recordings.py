"""Recordings that are changed by chance, in bytes and by type: tables, videos, sidecars, descriptions and folders."""

import json
import os
import warnings
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from shutil import copytree, rmtree

import numpy as np
import pyarrow.parquet as pq
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import changed_bytes, changed_data, pick
from fuzz.strange_infants import CANARIES, honest_bundle
from fuzz.table_mutations import changed_table, write_table

import mimoc
from mimoc.recording.video import require_av, write_pictures

CODECS = ("ffv1", "rawvideo", "mpeg4", "mjpeg", "h264", "vp8", "libvpx-vp9", "mp2", "flac")
"""Of videos, and of what is none."""
EXPORTS = ("csv", "lerobot", "minari", "recording")
INFANTS = (0, 1)  # Numbers of the honest bundles that are recorded: one sees, and one reaches and grows.


@dataclass(frozen=True, slots=True)
class Prepared:
    folders: tuple[Path, ...]
    bundles: tuple[mimoc.Bundle, ...]


def prepare(folder: Path) -> Prepared:
    bundles = tuple(_without_eyes(number) if number else honest_bundle(number) for number in INFANTS)
    for number, bundle in enumerate(bundles):
        _record(bundle, folder / f"running{number}", folder / f"recording{number}")
    return Prepared(tuple(folder / f"recording{number}" for number in range(len(bundles))), bundles)


def _without_eyes(number: int) -> mimoc.Bundle:
    spec = honest_bundle(number).manifest
    return mimoc.build(
        mimoc.InfantSpec.model_validate(
            {
                "mimoc": 1,
                "name": "child",
                "age_months": 9,
                "task": {"kind": spec.task.kind},
                "senses": {"proprioception": {}, "vestibular": {}, "touch": {"density": 0.2}},
            }
        )
    )


def _record(bundle: mimoc.Bundle, running: Path, kept: Path) -> None:
    """Record two episodes and a half; what is kept is as a kill leaves it."""
    env = mimoc.InfantEnv(bundle)
    for episode, part_rows in ((0, 5), (1, 5), (2, 2)):
        recorder = mimoc.Recorder(env, running, states_every=3, part_rows=part_rows)
        recorder.action_space.seed(episode)
        recorder.reset(seed=episode or None, options={"pose": bundle.manifest.pose})
        for step in range(4):
            recorder.step(recorder.action_space.sample())
            if step == 1:
                env.set_state(env.get_state())
        if episode < 2:
            recorder.recording.close()
    recorder.recording.wait()
    copytree(running, kept)
    recorder.close()


def attempt(prepared: Prepared, generator: np.random.Generator, folder: Path) -> None:
    which = int(generator.integers(len(prepared.folders)))
    place = folder / "recording"
    copytree(prepared.folders[which], place)
    for _ in range(1 if generator.random() < 0.8 else 2):
        change(generator, place, pick(generator, prepared.folders), folder.parent / "outside")
    use(generator, place, prepared.bundles[which], folder)


def change(generator: np.random.Generator, place: Path, other: Path, outside: Path) -> None:
    paths = [path for path in sorted(place.rglob("*")) if "bundles" not in path.parts or generator.random() < 0.005]
    files = [path for path in paths if path.is_file() and not path.is_symlink()]
    path = pick(generator, files)
    kind = generator.random()
    if kind < 0.08:
        plant(generator, pick(generator, paths), outside)
    elif kind < 0.16:
        theirs = pick(generator, [each for each in sorted(other.rglob("*")) if each.suffix == path.suffix] or [path])
        content = theirs.read_bytes() if theirs.is_file() else b""
        path.unlink()
        path.write_bytes(content)
    elif path.suffix == ".parquet" and kind < 0.9:
        _change_table(generator, path)
    elif path.suffix == ".json" and kind < 0.9:
        _change_json(generator, path)
    elif path.suffix == ".mkv" and kind < 0.9:
        _change_video(generator, path)
    else:
        path.write_bytes(changed_bytes(generator, path.read_bytes()))


def plant(generator: np.random.Generator, path: Path, outside: Path) -> None:
    """Put a link, a pipe, a folder or nothing in place of a file or a folder."""
    kept = path.with_name(f"{path.name}.kept")
    path.rename(kept)
    kind = int(generator.integers(6))
    if kind == 0:
        path.symlink_to(outside / pick(generator, sorted(CANARIES)))
    elif kind == 1:
        path.symlink_to(outside)
    elif kind == 2:
        path.symlink_to(kept.name)
    elif kind == 3:
        path.symlink_to(outside / "new")
    elif kind == 4:
        os.mkfifo(path) if generator.random() < 0.5 else path.mkdir()


def _change_json(generator: np.random.Generator, path: Path) -> None:
    try:
        data = json.loads(path.read_bytes())
    except ValueError:  # It was changed before.
        return
    path.write_bytes(json.dumps(changed_data(generator, data)).encode(errors="surrogateescape"))


def _change_table(generator: np.random.Generator, path: Path) -> None:
    try:
        table = pq.read_table(path)
    except Exception:  # It was changed before.
        return
    honest = path.read_bytes()
    try:
        write_table(generator, changed_table(generator, table), path)
    except Exception:  # There is no such file.
        path.unlink(missing_ok=True)
        path.write_bytes(changed_bytes(generator, honest))


def _change_video(generator: np.random.Generator, path: Path) -> None:
    """Write other pictures: of another codec, size or number."""
    sides = (16, 16) if generator.random() < 0.7 else (int(generator.integers(1, 99)), int(generator.integers(1, 99)))
    pictures = generator.integers(256, size=(int(generator.integers(1, 9)), *sides, 3), dtype=np.uint8)
    av = require_av()
    path.unlink(missing_ok=True)
    try:
        if generator.random() < 0.3:
            write_pictures(path, pictures, Fraction(100))
            return
        with av.open(str(path), "w", format=pick(generator, ("matroska", "matroska", "mp4", "nut"))) as container:
            stream = container.add_stream(pick(generator, CODECS), rate=50)
            stream.height, stream.width = sides
            stream.pix_fmt = stream.codec.video_formats[0].name
            for picture in pictures:
                container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, "rgb24")))
            container.mux(stream.encode())
    except (av.error.FFmpegError, ValueError, AttributeError, TypeError):  # There is no such file; this one is cut.
        path.touch()


def use(generator: np.random.Generator, place: Path, bundle: mimoc.Bundle, folder: Path) -> None:
    way = generator.random()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # Numbers that are none are averaged for statistics.
        if way < 0.25:
            read(place)
        elif way < 0.6:
            mimoc.export_recording(place, pick(generator, EXPORTS), folder / "exported")
        elif way < 0.7:
            mimoc.view(place, folder / "page.html")
        elif way < 0.85:
            list(map(str, mimoc.replay_recording(place)))
        elif way < 0.87:
            replay_to_video(place, folder / "video.gif")
        else:
            go_on(place, bundle)


def read(place: Path) -> None:
    recording = mimoc.read_recording(place)
    recording.summary()
    for episode in recording:
        _ = episode.observations, episode.states, episode.changes, episode.start, episode.options, episode.before
        _ = episode.actions, episode.infos, episode.reward_terms, episode.time_s, episode.columns()
        _ = episode.rewards, episode.terminated, episode.truncated, episode.step, episode.seed, episode.versions
    for infant in range(recording.infants):
        recording.bundle(infant)


def replay_to_video(place: Path, file: Path) -> None:
    """Simulate a recording again, and make a video of it, as `mimoc replay --video` does."""
    from mimoc.recording.record import film_of

    recording = mimoc.read_recording(place)
    if recording:
        with film_of(file, recording[0].step_ms, height_px=64) as film:
            watch = lambda one, observation: film({one.name: one}, {one.name: observation})  # noqa: E731
            list(mimoc.replay_recording(recording, watch=watch))


def go_on(place: Path, bundle: mimoc.Bundle) -> None:
    """Record another episode in the same folder, which first puts in order what a kill has left."""
    with mimoc.Recorder(mimoc.make(bundle), place, part_rows=2) as env:
        env.reset(seed=0)
        for _ in range(3):
            env.step(env.action_space.sample())
    rmtree(place)


FUZZER = Fuzzer(prepare, attempt, short=10)
