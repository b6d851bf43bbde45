"""What an infant could see of things: in front of all else, within the field that it notices, and in focus."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.model import in_subtrees
from mimoc.components.senses.vision import VisionEntry
from mimoc.components.senses.vision.run import lens_of
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.sense import FloatArray, IntArray

BoolArray = npt.NDArray[np.bool_]

BEYOND_M = 1e-6  # How far behind a surface of head or eyes a line of sight goes on.


@dataclass(frozen=True, slots=True)
class Thing:
    """Something that can be seen."""

    is_part: BoolArray  # Which bodies of the model are parts of it, shape (nbody,).
    geoms: IntArray  # Its geoms whose middles are looked for, shape (n,).


@dataclass(frozen=True, slots=True)
class Points:
    """The middles of the geoms of a thing that nothing hides from an eye, shape (p,), of both eyes together."""

    angles_deg: FloatArray  # From the line of sight of the eye.
    depths_m: FloatArray  # How far away they are along it.
    is_sharp: BoolArray  # Whether they are in focus.

    def within(self, angle_deg: float, *, sharp: bool = False) -> bool:
        """Return whether one of them is so near to a line of sight, and perhaps in focus as well."""
        near = self.angles_deg <= angle_deg
        return bool((near & self.is_sharp if sharp else near).any())


class Sight:
    """The lines of sight from an infant's eyes to things.

    A line goes from the camera of an eye to the middle of a geom. What it meets first counts, but for head and eyes,
    which infants do not see. Middles of geoms behind an eye are at more than 90 degrees.
    """

    def __init__(self, env: InfantEnv, entry: VisionEntry):
        """Look with the eyes of an infant, as mature as *entry* says; it needs no pictures."""
        self._env, model = env, env.model
        self._cameras = [model.camera(eye.camera).id for eye in env.manifest.anatomy.eyes]
        self._unseen = {model.body(name).id for name in entry.unseen}
        self._lens = lens_of(entry)
        self._geom = np.zeros(1, np.int32)

    def thing(self, body: str, geoms: Sequence[str] = ()) -> Thing:
        """Return a body with all that hangs on it, to be looked for at some of its geoms, or at all."""
        model = self._env.model
        is_part = in_subtrees(model, [model.body(body).id])
        named = [model.geom(name).id for name in geoms]
        return Thing(is_part, np.array(named or np.flatnonzero(is_part[model.geom_bodyid]), np.intp))

    def points(self, thing: Thing) -> Points:
        """Return what of a thing is seen now by either eye, wherever it looks."""
        data, rows = self._env.data, list[tuple[float, float]]()
        for camera in self._cameras:
            eye_m, ahead = data.cam_xpos[camera], -data.cam_xmat[camera].reshape(3, 3)[:, 2]
            for geom in thing.geoms:
                away_m = data.geom_xpos[geom] - eye_m
                body = self._met(camera, eye_m, away_m)
                if body >= 0 and thing.is_part[body]:
                    depth_m = float(away_m @ ahead)
                    rows.append((depth_m / float(np.linalg.norm(away_m)), depth_m))
        cosines, depths_m = np.array(rows).reshape(-1, 2).T
        blurred_deg = np.zeros(len(rows)) if self._lens is None else self._lens.disc_deg(depths_m)
        return Points(np.degrees(np.arccos(cosines.clip(-1, 1))), depths_m, blurred_deg == 0)

    def gaze_deg(self, place_m: FloatArray) -> float:
        """Return the angle between the line of sight and a place, shape (3,), of the eye that looks farther from it."""
        data, angles = self._env.data, list[float]()
        for camera in self._cameras:
            away_m = place_m - data.cam_xpos[camera]
            cosine = -data.cam_xmat[camera].reshape(3, 3)[:, 2] @ away_m / np.linalg.norm(away_m)
            angles.append(float(np.degrees(np.arccos(np.clip(cosine, -1, 1)))))
        return max(angles)

    def _met(self, camera: int, eye_m: FloatArray, away_m: FloatArray) -> int:
        """Return the body that a line from an eye meets first, beside what it never sees; -1 for none."""
        model, data, begin_m = self._env.model, self._env.data, eye_m
        towards = away_m / np.linalg.norm(away_m)
        while True:
            further = mujoco.mj_ray(model, data, begin_m, towards, None, 1, int(model.cam_bodyid[camera]), self._geom)
            if further < 0:
                return -1
            body = int(model.geom_bodyid[self._geom[0]])
            if body not in self._unseen:
                return body
            begin_m = begin_m + (further + BEYOND_M) * towards
