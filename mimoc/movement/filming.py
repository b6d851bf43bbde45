"""Simulated infants as a camera above them sees them: at its rate, in whole pixels, in the size of real infants."""

from dataclasses import dataclass, field, replace

import mujoco
import numpy as np

from mimoc.base.errors import MovementError
from mimoc.bundle.manifest import ChildEntry
from mimoc.compiler.provenance import SCALE_NOT_KNOWN
from mimoc.motion.body_points import locate
from mimoc.motion.point_recording import MINI_RGBD_CAMERA, FloatArray, PointRecording
from mimoc.motion.points import MINI_RGBD_POINTS, SIDES
from mimoc.movement.trunk_frame import LEAST_S
from mimoc.runtime.infant import Infant

RATE_HZ = 30.0
"""Frames per second of MINI-RGBD, as its files are read."""
TRUNK_PX = 138.0
"""Mean length of the trunk of the infants of MINI-RGBD: the camera is as high as this needs."""
SETTLING_S = 1.0
"""Beginning of an episode that is left out, in which an infant starts from rest."""
SPACE_POINTS = (*MINI_RGBD_POINTS, *(f"{side}_ankle" for side in SIDES))


@dataclass(frozen=True)
class Filmed:
    """An infant whose movement is measured."""

    seen: PointRecording
    """Its points, as recorded or as a camera above it sees them."""
    space: PointRecording | None = None
    """Its points in the world, [m], of a simulated infant."""


@dataclass
class Film:
    """Collects the configurations of one simulated infant after each control step, and develops them."""

    times_s: list[float] = field(default_factory=list)
    places_m: list[FloatArray] = field(default_factory=list)
    """Points of blocks of control steps, shape (s, k, 3) each."""
    _model: mujoco.MjModel | None = None
    _child: ChildEntry | None = None
    _prefix: str = ""
    _block: list[FloatArray] = field(default_factory=list)

    def watch(self, env: Infant, observation: object = None) -> None:
        """Keep where the infant is now; it may have grown since the last step, but not started a new episode."""
        if env.model is not self._model:
            self._locate()
            self._model, self._child, self._prefix = env.model, env.manifest.child, env.manifest.prefix
        self.times_s.append(float(env.data.time))
        self._block.append(env.data.qpos.copy())

    def develop(self, name: str) -> Filmed:
        """Return what the camera saw, without the first second; MovementError if it is too short to measure."""
        self._locate()
        times_s = np.array(self.times_s)
        times_s -= times_s[0] if len(times_s) else 0.0
        least_s = SETTLING_S + LEAST_S
        if not len(times_s) or times_s[-1] < least_s - 1e-6:
            reason = f"record at least {least_s:g} s, since the first {SETTLING_S:g} s is not measured"
            raise MovementError(f"{name}: too short to measure movement; {reason}")
        return noted(film_places(name, times_s, np.concatenate(self.places_m), SETTLING_S), self._child)

    def _locate(self) -> None:
        if self._model is not None and self._block:
            self.places_m.append(locate(self._model, np.array(self._block), SPACE_POINTS, self._prefix))
            self._block.clear()


def noted(film: Filmed, child: ChildEntry | None) -> Filmed:
    """Return a film with a note if its child's scale is not known."""
    if child is None or child.size_is_known:
        return film
    notes = (*film.seen.notes, f"{SCALE_NOT_KNOWN}; measures in lengths of the trunk do not depend on it")
    return replace(film, seen=replace(film.seen, notes=notes))


def film_places(name: str, times_s: FloatArray, places_m: FloatArray, start_s: float = 0.0) -> Filmed:
    """Return what a camera that looks straight down on an infant sees at 30 frames/s, rounded to whole pixels.

    Its picture has world x to the right and world -y downwards. It stands above the mean place of the hips, at the
    height at which the trunk is as long as those of MINI-RGBD, f T / h = 138 px. Times rise, shape (s,), and places are
    those of `SPACE_POINTS` in the world, shape (s, k, 3).
    """
    count = int((times_s[-1] - start_s) * RATE_HZ + 1e-6) + 1
    frames_s = start_s + np.arange(count) / RATE_HZ
    flat = places_m.reshape(len(places_m), -1)
    world = np.stack([np.interp(frames_s, times_s, column) for column in flat.T], axis=-1)
    world = world.reshape(count, *places_m.shape[1:])
    confidence = np.isfinite(world).all(axis=-1).astype(float)
    space = PointRecording(name, RATE_HZ, SPACE_POINTS, world, confidence)
    middle = space.hips.mean(axis=0)
    height_m = MINI_RGBD_CAMERA.focal_px[0] * space.trunk / TRUNK_PX
    away = np.stack(
        [world[..., 0] - middle[0], middle[1] - world[..., 1], height_m + middle[2] - world[..., 2]], axis=-1
    )
    kept = len(MINI_RGBD_POINTS)
    pixels = np.rint(MINI_RGBD_CAMERA.project(away))[:, :kept]
    seen = PointRecording(name, RATE_HZ, MINI_RGBD_POINTS, pixels, confidence[:, :kept], MINI_RGBD_CAMERA)
    return Filmed(seen, space)
