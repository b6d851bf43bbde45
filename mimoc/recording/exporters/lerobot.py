"""A recording in the layout of LeRobot's data sets, version 3: Parquet, MP4 and JSON.

One file of rows, one video for each eye, one table of episodes and one of tasks, as in the public documentation of the
format (huggingface.co/docs/lerobot/lerobot-dataset-v3).
"""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from mimoc.recording.columns import Array, Reading
from mimoc.recording.reading import Episode, ReadRecording
from mimoc.recording.video import SMALL, Mp4

VERSION = "v3.0"
MOVEMENT_NOTE = (
    "movement columns of texts (what is touched or looked at) are left out, and empty cells, such as where a gaze meets"
    " nothing, are zeros: the format has numbers only"
)
FILE = "chunk-000/file-000"
CHUNK_FILES, DATA_MB, VIDEO_MB = 1000, 100, 200
"""Limits of the format's own writer, which say how it goes on from here."""
MOMENTS = ("min", "max", "mean", "std")
MOVEMENT = "observation.movement"
STATE, IMAGES = "observation.state", "observation.images."
STEP_COLUMNS = {"timestamp": "float32", "frame_index": "int64", "episode_index": "int64", "index": "int64"}
STEP_COLUMNS |= {"task_index": "int64", "next.reward": "float32", "next.done": "bool", "next.success": "bool"}
"""Columns with one number a row, with their types."""


def export(recording: ReadRecording, out: Path, progress: Callable[[int, int], None]) -> list[str]:
    """Write a data set of LeRobot's: a row for each control step, with what was observed before it."""
    readings = recording[0].described.readings
    task = recording.bundle().manifest.task.kind
    eyes = [reading for reading in readings if reading.kind == "picture"]
    total, start = (1 + len(eyes)) * len(recording), 0
    tables, stats, spans = [], [], []
    for number, episode in enumerate(recording):
        progress(number, total)
        columns = _columns(episode, number, start)
        stats.append({name: _stats(array) for name, array in columns.items()})
        tables.append(pa.table({name: _column(array) for name, array in columns.items()}))
        end, rate = start + episode.steps, episode.described.rate_hz
        place = {"episode_index": number, "tasks": [task], "length": episode.steps}
        place |= {"data/chunk_index": 0, "data/file_index": 0, "dataset_from_index": start, "dataset_to_index": end}
        place |= {"meta/episodes/chunk_index": 0, "meta/episodes/file_index": 0}
        video = {"chunk_index": 0, "file_index": 0}
        video |= {"from_timestamp": float(start / rate), "to_timestamp": float(end / rate)}
        spans.append(place | {f"videos/{_feature(eye)}/{name}": value for eye in eyes for name, value in video.items()})
        start += episode.steps
    _write(out / "data" / f"{FILE}.parquet", pa.concat_tables(tables))
    for done, reading in enumerate(eyes, start=1):
        progress(done * len(recording), total)
        _write_pictures(out, recording, reading, stats)
    _write(out / "meta" / "tasks.parquet", _tasks(task))
    rows = [
        span | {f"stats/{name}/{what}": value for name, numbers in features.items() for what, value in numbers.items()}
        for span, features in zip(spans, stats, strict=True)
    ]
    _write(out / "meta" / "episodes" / f"{FILE}.parquet", pa.Table.from_pylist(rows))
    _write_json(out / "meta" / "info.json", _info(recording, eyes))
    _write_json(out / "meta" / "stats.json", _joined(stats))
    sparse = [reading.name for reading in readings if reading.kind == "sparse"]
    return [
        *(f"'{name}' is written in full, with all its zeros: the format has no sparse columns" for name in sparse),
        *([MOVEMENT_NOTE] if recording[0].described.movement else []),
        *(["pictures are videos with losses: the recording has them without"] if eyes else []),
        "what was observed last, terms of the reward, states and seeds are left out: the format has no place for them",
    ]


def _columns(episode: Episode, number: int, start: int) -> dict[str, Array]:
    steps = episode.steps
    done = np.zeros(steps, bool)
    done[-1] = True
    columns: dict[str, Array] = {"action": episode.actions.astype(np.float32)}
    for reading in episode.described.readings:
        if reading.kind != "picture":
            columns[_feature(reading)] = episode.observation(reading.name)[:-1].reshape(steps, -1)
    if numbers := episode.described.movement:
        movement = [np.nan_to_num(episode.movement[name][:-1]) for name in numbers]
        columns[MOVEMENT] = np.stack(movement, axis=1)
    return columns | {
        "timestamp": (np.arange(steps) / float(episode.described.rate_hz)).astype(np.float32),
        "frame_index": np.arange(steps),
        "episode_index": np.full(steps, number),
        "index": np.arange(start, start + steps),
        "task_index": np.zeros(steps, np.int64),
        "next.reward": episode.rewards.astype(np.float32),
        "next.done": done,
        "next.success": episode.infos.get("is_success", np.zeros(steps)) == 1,
    }


def _feature(reading: Reading) -> str:
    if reading.kind == "picture":
        return IMAGES + reading.name
    return STATE if reading.name == "proprioception" else f"observation.{reading.name}"


def _column(array: Array) -> Any:
    flat = pa.array(array.reshape(-1))
    return flat if array.ndim == 1 else pa.FixedSizeListArray.from_arrays(flat, array.shape[1])


def _tasks(task: str) -> Any:
    table = pa.table({"task_index": pa.array([0], pa.int64()), "task": [task]})
    index = {"index_columns": ["task"], "column_indexes": [], "columns": [], "pandas_version": "2.0.0"}
    index["columns"] = [
        {"name": name, "field_name": name, "pandas_type": kind, "numpy_type": numpy, "metadata": None}
        for name, kind, numpy in (("task_index", "int64", "int64"), ("task", "unicode", "object"))
    ]
    return table.replace_schema_metadata({b"pandas": json.dumps(index).encode()})


def _stats(array: Array) -> dict[str, Any]:
    rows = array.reshape(len(array), -1).astype(np.float64)
    return {what: getattr(rows, what)(axis=0).tolist() for what in MOMENTS} | {"count": [len(array)]}


def _joined(stats: Sequence[dict[str, dict[str, Any]]]) -> dict[str, Any]:
    features: dict[str, Any] = {}
    for name in stats[0]:
        parts = {what: np.array([episode[name][what] for episode in stats]) for what in stats[0][name]}
        count = parts["count"].reshape(-1, *([1] * (parts["mean"].ndim - 1)))
        mean = (parts["mean"] * count).sum(axis=0) / count.sum()
        square = ((parts["std"] ** 2 + (parts["mean"] - mean) ** 2) * count).sum(axis=0) / count.sum()
        extremes = {"min": parts["min"].min(axis=0), "max": parts["max"].max(axis=0)}
        joined = {**extremes, "mean": mean, "std": np.sqrt(square)}
        features[name] = {what: values.tolist() for what, values in joined.items()} | {"count": [int(count.sum())]}
    return features


def _write_pictures(out: Path, recording: ReadRecording, eye: Reading, stats: Sequence[dict[str, Any]]) -> None:
    path = out / "videos" / _feature(eye) / f"{FILE}.mp4"
    path.parent.mkdir(parents=True)
    video = Mp4(path, recording[0].described.rate_hz, SMALL)
    for episode, features in zip(recording, stats, strict=True):
        pictures = episode.observation(eye.name)[:-1]
        for picture in pictures:
            video.add(picture)
        numbers = _stats(pictures.reshape(-1, 3) / 255)
        features[_feature(eye)] = {what: [[[value]] for value in numbers[what]] for what in MOMENTS} | {
            "count": [len(pictures)]
        }
    video.save()


def _info(recording: ReadRecording, eyes: Sequence[Reading]) -> dict[str, Any]:
    rate = recording[0].described.rate_hz
    video_path = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
    return {
        "codebase_version": VERSION,
        "robot_type": "mimoc",
        "total_episodes": len(recording),
        "total_frames": sum(episode.steps for episode in recording),
        "total_tasks": 1,
        "chunks_size": CHUNK_FILES,
        "data_files_size_in_mb": DATA_MB,
        "video_files_size_in_mb": VIDEO_MB,
        "fps": int(rate) if rate.denominator == 1 else float(rate),
        "splits": {"train": f"0:{len(recording)}"},
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": video_path if eyes else None,
        "features": _features(recording[0]),
    }


def _features(episode: Episode) -> dict[str, Any]:
    actions = list(episode.layout("action"))
    features: dict[str, Any] = {"action": {"dtype": "float32", "shape": [len(actions)], "names": actions}}
    rate = float(episode.described.rate_hz)
    for reading in episode.described.readings:
        if reading.kind == "picture":
            height, width, channels = reading.shape
            video = {"video.height": height, "video.width": width, "video.codec": "h264", "video.pix_fmt": "yuv420p"}
            video |= {"video.is_depth_map": False, "video.fps": rate, "video.channels": channels, "has_audio": False}
            names = ["height", "width", "channels"]
            features[_feature(reading)] = {"dtype": "video", "shape": [*reading.shape], "names": names, "info": video}
        else:
            names = list(reading.layout) or None
            features[_feature(reading)] = {"dtype": reading.dtype, "shape": [reading.size], "names": names}
    if movement := list(episode.described.movement):
        features[MOVEMENT] = {"dtype": "float32", "shape": [len(movement)], "names": movement}
    return features | {name: {"dtype": kind, "shape": [1], "names": None} for name, kind in STEP_COLUMNS.items()}


def _write(path: Path, table: Any) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, path, compression="zstd")


def _write_json(path: Path, data: Any) -> None:
    path.write_text(json.dumps(data, indent=4, ensure_ascii=False) + "\n", encoding="utf-8")
