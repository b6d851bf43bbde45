"""Infants that are filmed while they kick, and files as pose estimators, MINI-RGBD and motion capture write them."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
from scipy.ndimage import gaussian_filter1d

import mimoc
from mimoc.motion.body_points import film, locate
from mimoc.motion.labels import MINI_RGBD_POINTS, known_name
from mimoc.motion.point_recording import FloatArray, PointRecording
from mimoc.motion.read_coco import COCO_17
from mimoc.motion.read_mediapipe import LANDMARKS
from mimoc.motion.read_mini_rgbd import FOLDERS, JOINTS, POINTS
from mimoc.motion.read_openpose import BODY_25
from mimoc.motion.timing import metres_in, seconds_in

BODY_25_POINTS = tuple(map(known_name, BODY_25))


@cache
def kicking_model() -> mujoco.MjModel:
    spec = mimoc.InfantSpec(mimoc=1, name="kicking", age_months=3, senses={"proprioception": {}})
    return mimoc.make(spec).unwrapped.model


def kicking(frames: int, seed: int = 0) -> FloatArray:
    """Return smooth random joint angles of a supine infant, shape (frames, nq)."""
    model, generator = kicking_model(), np.random.default_rng(seed)
    qpos = np.repeat(model.qpos0[None], frames, axis=0)
    noise = gaussian_filter1d(generator.normal(size=(frames + 60, model.nq)), 8, axis=0)[30:-30]
    for joint in range(model.njnt):
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE:
            at, (low, high) = model.jnt_qposadr[joint], model.jnt_range[joint]
            share = 0.5 + 0.25 * noise[:, at] / max(noise[:, at].std(), 1e-9)
            qpos[:, at] = low + (high - low) * share.clip(0.05, 0.95)
    qpos[:, 3:7] = SUPINE
    return qpos


def beside(recording: PointRecording, scale: float = 1.0, radii: float = 2.5, *, still: bool = False) -> PointRecording:
    """Return somebody else, who moves as it does or not at all, beside it by some radii of its body."""
    positions = recording.positions[:1].repeat(recording.frames, axis=0) if still else recording.positions
    middle = np.nanmean(positions, axis=(0, 1))
    radius = np.nanmean(np.linalg.norm(positions - middle, axis=-1))
    return replace(recording, positions=(positions - middle) * scale + middle + [radii * radius, 0])


def missed(recording: PointRecording, frames: Any) -> PointRecording:
    positions = recording.positions.copy()
    positions[frames] = np.nan
    return replace(recording, positions=positions)


def without_neck(recording: PointRecording) -> PointRecording:
    """Return what pose estimators see: what they call a neck is the middle of the shoulders, or nothing."""
    return recording.select([name for name in recording.names if name != "neck"])


SUPINE = np.array([np.sqrt(0.5), 0.0, -np.sqrt(0.5), 0.0])
"""How the root is turned of an infant on its back, as a quaternion."""


def filmed(frames: int = 60, names: tuple[str, ...] = MINI_RGBD_POINTS, seed: int = 0) -> PointRecording:
    return replace(film(kicking_model(), kicking(frames, seed), 30.0, names), depth_m=None, name="kicking")


def in_space(frames: int = 60, names: tuple[str, ...] = MINI_RGBD_POINTS, seed: int = 0) -> PointRecording:
    places_m = locate(kicking_model(), kicking(frames, seed), names)
    return PointRecording("kicking", 30.0, names, places_m, np.ones(places_m.shape[:2]))


def write_openpose(
    recording: PointRecording,
    folder: Path,
    others: tuple[PointRecording, ...] = (),
    identities: tuple[int | Sequence[int], ...] = (),
) -> Path:
    """Write BODY_25 as OpenPose does, a file for each frame, with other persons before the infant.

    Whoever is not seen in a frame is left out. Identities are of each, in all frames or by frame.
    """
    folder.mkdir()
    persons = *others, recording
    tables = [_table(person, BODY_25_POINTS) for person in persons]
    who = [np.broadcast_to(one, recording.frames).tolist() for one in identities or [-1] * len(persons)]
    empty = {f"{part}_keypoints_{dimension}": [] for part in ("face", "hand_left") for dimension in ("2d", "3d")}
    for frame in range(recording.frames):
        people = [
            {"person_id": [name[frame]], "pose_keypoints_2d": table[frame], **empty}
            for table, name in zip(tables, who, strict=True)
            if any(table[frame])
        ]
        content = json.dumps({"version": 1.3, "people": people}, separators=(",", ":"))
        (folder / f"film_{frame:012d}_keypoints.json").write_text(content)
    return folder


def coco_entries(recording: PointRecording, **keys: object) -> list[dict[str, object]]:
    table = _table(recording, COCO_17)
    return [
        {"image_id": frame, "category_id": 1, "keypoints": row, "score": 0.9, **keys} for frame, row in enumerate(table)
    ]


def write_coco(recording: PointRecording, path: Path) -> Path:
    """Write COCO-17: one file, or a folder with one for each frame."""
    entries = coco_entries(recording)
    if path.suffix:
        path.write_text(json.dumps(entries))
        return path
    path.mkdir()
    for frame, entry in enumerate(entries):
        (path / f"{frame:06d}.json").write_text(json.dumps([entry]))
    return path


def write_categories(recordings: Mapping[str, PointRecording], path: Path) -> Path:
    """Write annotations in COCO's form of persons of several categories; every second has its points reversed."""
    orders = [COCO_17[:: (-1) ** number] for number in range(len(recordings))]
    categories = [
        {"id": number + 1, "name": name, "keypoints": [*order]}
        for number, (name, order) in enumerate(zip(recordings, orders, strict=True))
    ]
    annotations = [
        {"image_id": frame, "category_id": number + 1, "keypoints": row}
        for number, (one, order) in enumerate(zip(recordings.values(), orders, strict=True))
        for frame, row in enumerate(_table(one, order))
    ]
    frames = max(one.frames for one in recordings.values())
    images = [{"id": frame, "file_name": f"film_{frame:04d}_cam2.jpg"} for frame in range(frames)]
    path.write_text(json.dumps({"images": images, "annotations": annotations, "categories": categories}))
    return path


def write_mmpose(recording: PointRecording, path: Path, **meta: object) -> Path:
    """Write what MMPose does of a video, with the names of points in reverse order in `meta_info`."""
    names = COCO_17[::-1]
    rows = np.array(_table(recording, names)).reshape(recording.frames, -1, 3)
    frames = [
        {"frame_id": frame, "instances": [{"keypoints": row[:, :2].tolist(), "keypoint_scores": row[:, 2].tolist()}]}
        for frame, row in enumerate(rows)
    ]
    meta = meta or {"keypoint_id2name": {str(number): name for number, name in enumerate(names)}}
    path.write_text(json.dumps({"meta_info": {"dataset_name": "ours", **meta}, "instance_info": frames}))
    return path


def write_times(recording: PointRecording, times: FloatArray, path: Path, column: str = "time_s") -> Path:
    """Write a table with a row for each of some times; points are interpolated between frames."""
    when = np.arange(recording.frames) / recording.rate_hz
    flat = recording.positions.reshape(recording.frames, -1)
    seconds = times * (seconds_in(column.rpartition("_")[2]) or 1)
    values = np.stack([np.interp(seconds, when, one) for one in flat.T], axis=1)
    header = [
        column,
        *(f"{name}_{axis}" for name in recording.names for axis in "xyz"[: recording.positions.shape[-1]]),
    ]
    rows = [[time, *row] for time, row in zip(times.tolist(), values.tolist(), strict=True)]
    path.write_text("\n".join(",".join(map(str, row)) for row in [header, *rows]))
    return path


def write_pairs(recording: PointRecording, path: Path) -> Path:
    """Write the form of public keypoints of MINI-RGBD: semicolons, and cells of x and y."""
    rows = [
        [f"{frame:05d}.png", *(f"{x!r},{y!r}" for x, y in row)]
        for frame, row in enumerate(recording.positions.tolist())
    ]
    path.write_text("\n".join(";".join(row) for row in [["image", *recording.names], *rows]))
    return path


def landmarks(recording: PointRecording) -> FloatArray:
    """Return MediaPipe's landmarks, shape (t, 33, 4): x, y, z and visibility, which is low for those not recorded.

    Pixels become shares of a picture of 640 x 480 pixels, with a z; places in space become metres from the hips, y
    downwards, as a camera sees them that looks straight down.
    """
    table = np.full((recording.frames, len(LANDMARKS), 4), 0.01)
    if recording.unit == "px":
        places = np.concatenate([recording.positions / (640, 480), recording.positions[..., :1] * 0 + 0.1], axis=-1)
    else:
        places = (recording.positions - recording.hips[:, None]) * (1, -1, -1)
    for index, name in enumerate(map(known_name, LANDMARKS)):
        if name in recording.names:
            table[:, index] = np.insert(places[:, recording.names.index(name)], 3, 0.99, axis=-1)
    return table


def write_mediapipe(recording: PointRecording, path: Path) -> Path:
    """Write landmarks, as a table with a row for each frame or as JSON with a list for each."""
    table = landmarks(recording)
    keys = "x", "y", "z", "visibility"
    if path.suffix == ".json":
        frames = [[dict(zip(keys, point, strict=True)) for point in points] for points in table.tolist()]
        path.write_text(json.dumps([{"frame": frame, "landmarks": points} for frame, points in enumerate(frames)]))
        return path
    header = ["frame", *(f"{name}_{key}" for name in LANDMARKS for key in keys)]
    rows = [[frame, *row] for frame, row in enumerate(table.reshape(recording.frames, -1).tolist())]
    path.write_text("\n".join(",".join(map(str, row)) for row in [header, *rows]))
    return path


def write_deeplabcut(recordings: Mapping[str, PointRecording], path: Path) -> Path:
    """Write DeepLabCut's table of several individuals by their names, with its four rows of titles."""
    axes, some = ("x", "y", "likelihood"), [*recordings.values()]
    columns = [(name, point, axis) for name, one in recordings.items() for point in one.names for axis in axes]
    titles = ("individuals", "bodyparts", "coords")
    header = [["scorer", *["net"] * len(columns)], *map(list, zip(titles, *columns, strict=True))]
    values = np.concatenate(
        [np.insert(one.positions, 2, 0.99, axis=-1).reshape(one.frames, -1) for one in some], axis=1
    )
    rows = [[frame, *row] for frame, row in enumerate(values.tolist())]
    path.write_text("\n".join(",".join(map(str, row)) for row in [*header, *rows]))
    return path


def write_c3d(recording: PointRecording, path: Path, labels: tuple[str, ...] = (), unit: str = "mm") -> Path:
    """Write markers, as laboratories of motion capture do; `ezc3d` must be installed."""
    import ezc3d

    file = ezc3d.c3d()
    file["parameters"]["POINT"]["RATE"]["value"] = [recording.rate_hz]
    file["parameters"]["POINT"]["LABELS"]["value"] = list(labels or recording.names)
    file["parameters"]["POINT"]["UNITS"]["value"] = [unit]
    places = recording.positions.transpose(2, 1, 0) / (metres_in(unit or "mm") or 1)
    file["data"]["points"] = np.concatenate([places, np.ones((1, *places.shape[1:]))])
    file.write(str(path))
    return path


def _table(recording: PointRecording, names: tuple[str, ...]) -> list[list[float]]:
    """Return x, y and confidence of some points in each frame, one after the other; three zeros of those not seen."""
    table = np.zeros((recording.frames, len(names), 3))
    for index, name in enumerate(names):
        if name in recording.names:
            at = recording.names.index(name)
            seen = np.isfinite(recording.positions[:, at]).all(axis=1)
            table[seen, index, :2] = recording.positions[seen, at]
            table[seen, index, 2] = recording.confidence[seen, at]
    return table.reshape(recording.frames, -1).round(3).tolist()


def write_mini_rgbd(recording: PointRecording, folder: Path) -> Path:
    """Write a recording as a sequence of MINI-RGBD: joints in pixels with their depth, or in space.

    Of 25 joints it has those that are points of the recording and are seen; places in space are in the frame of a
    camera that looks down from the height of 1 m.
    """
    joints = FOLDERS[recording.unit == "m"]
    place = folder / joints.folder
    place.mkdir(parents=True, exist_ok=True)
    numbers = [JOINTS.index(POINTS[name]) for name in recording.names]
    depth_m = np.zeros(recording.confidence.shape) if recording.depth_m is None else recording.depth_m
    columns = np.concatenate([recording.positions, depth_m[..., None]], axis=-1)[..., :3]
    if joints.in_space:
        columns = columns * (1.0, -1.0, -1.0) + (0.0, 0.0, 1.0)
    for frame, rows in enumerate(columns.tolist()):
        seen = [(row, number) for row, number in zip(rows, numbers, strict=True) if not math.isnan(sum(row))]
        text = "".join(f"{first!r} {second!r} {third!r} {number}\n" for (first, second, third), number in seen)
        (place / f"{joints.prefix}{frame:05d}.txt").write_text(text)
    return folder
