"""Recordings of points as mimoc writes them: arrays in one NumPy archive, without pickles."""

from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from mimoc.base.errors import BundleError
from mimoc.bundle.io import pack_arrays, unpack_arrays
from mimoc.bundle.regular_files import UnusableFileError, problems_in
from mimoc.motion.frame_files import MAX_FRAMES, read_whole_file
from mimoc.motion.point_recording import Camera, PointRecording, ReadOptions
from mimoc.schema.base import Model

Pair = tuple[float, float]


class _Camera(Model):
    """A camera, as it stands in the file."""

    focal_px: Pair
    centre_px: Pair
    size_px: tuple[int, int]


class _About(Model):
    """All of a recording but its numbers."""

    name: str
    rate_hz: float
    names: tuple[str, ...]
    camera: _Camera | None
    notes: tuple[str, ...]


def recognise(path: Path) -> bool:
    """Return whether its name ends in `.npz`."""
    return path.suffix.lower() == ".npz"


def read(path: Path, options: ReadOptions) -> PointRecording:
    """Return a recording that `write_points` has written; an UnusableFileError says that it is none."""
    try:
        arrays = unpack_arrays(read_whole_file(path))
        about = _About.model_validate_json(arrays["about"].tobytes())
    except (BundleError, KeyError):
        raise UnusableFileError("is not as mimoc.write_points writes it, or damaged; write it again") from None
    except ValidationError as error:
        raise UnusableFileError(f"about: {problems_in(error)}; write it again") from None
    numbers = {name: arrays.get(name, np.zeros(0)).astype(np.float64) for name in ("positions", "confidence")}
    depth_m = arrays["depth_m"].astype(np.float64) if "depth_m" in arrays else None
    positions, confidence = numbers["positions"], numbers["confidence"]
    shape = positions.shape[:-1]
    is_whole = positions.ndim == 3 and positions.shape[-1] in (2, 3) and shape[1] == len(about.names)
    if not is_whole or confidence.shape != shape or (depth_m is not None and depth_m.shape != shape):
        raise UnusableFileError("has arrays whose shapes do not fit each other; write it again")
    if len(positions) > MAX_FRAMES:
        raise UnusableFileError(f"has {len(positions):,} frames; mimoc reads up to {MAX_FRAMES:,}: cut it")
    camera = Camera(**dict(about.camera)) if about.camera else None
    return PointRecording(about.name, about.rate_hz, about.names, positions, confidence, camera, depth_m, about.notes)


def pack(recording: PointRecording, **others: Any) -> bytes:
    """Return the archive of a recording, with other arrays, which `read` passes over."""
    camera = recording.camera and _Camera(
        focal_px=recording.camera.focal_px, centre_px=recording.camera.centre_px, size_px=recording.camera.size_px
    )
    about = _About(
        name=recording.name, rate_hz=recording.rate_hz, names=recording.names, camera=camera, notes=recording.notes
    )
    text = np.frombuffer(about.model_dump_json().encode(), np.uint8)
    depth = {} if recording.depth_m is None else {"depth_m": recording.depth_m}
    numbers = {"positions": recording.positions, "confidence": recording.confidence, **depth}
    return pack_arrays({**others, "about": text, **numbers})
