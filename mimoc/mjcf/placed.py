"""What a sense adds to the MJCF."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy.typing as npt

from mimoc.mjcf.infant import Camera, Sensor, Site
from mimoc.schema.base import Model


@dataclass(frozen=True, slots=True)
class Placed:
    """A sense on a body: its entry in the manifest, and what stands for it in the MJCF."""

    entry: Model
    """What the runtime must know of it."""
    sites: Mapping[str, tuple[Site, ...]] = field(default_factory=dict)
    """Sites to add, by body."""
    cameras: Mapping[str, tuple[Camera, ...]] = field(default_factory=dict)
    """Cameras by body, in place of those that the body has without the sense."""
    sensors: tuple[Sensor, ...] = ()
    """Sensors to add."""
    arrays: Mapping[str, npt.NDArray[Any]] = field(default_factory=dict)
    """Large arrays that the runtime must know; the bundle has `points_m` of touch as `touch/points_m`."""
    origins: Mapping[str, dict[str, Any]] = field(default_factory=dict)
    """Where its numbers come from, by key in `provenance.json`."""
