"""What a caregiver sees, hears and feels of an infant, and when it does something that can be answered."""

import math
from collections.abc import Callable
from typing import Any

import mujoco
import numpy as np

from mimoc.base.geometry.rotations import FloatArray
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.runtime.sound import SoundSources, Voice

LOOKING_RAD, LOOKED_AWAY_RAD = math.radians(15), math.radians(20)
"""Angle between gaze and face up to which an infant looks at the face, and beyond which it looks elsewhere; an
assumption."""
SPOKEN_DB = 40.0
"""Sound pressure level at 1 m from which on the infant's voice is answered, a quiet voice; an assumption."""
LOOK_S = 0.2  # How long a look is at least; an assumption.


class Infant:
    """An infant as a caregiver sees it, by names of the manifest."""

    def __init__(self, manifest: Manifest, model: mujoco.MjModel):
        anatomy = manifest.anatomy
        self.root = model.body(manifest.root_body).id
        inside = in_subtrees(model, [self.root])
        self.is_its_geom = inside[model.geom_bodyid]
        """Whether a geom is the infant's, shape (ngeom,)."""
        self.head = model.body(anatomy.head or manifest.root_body).id
        self.weight_n = float(model.body_subtreemass[self.root] * -model.opt.gravity[2])
        self.legs = [(model.body(leg.root).id, model.body(leg.end).id) for leg in anatomy.legs if leg.end]
        self.hands = [model.body(arm.end).id for arm in anatomy.arms if arm.end]
        self._cameras = [model.camera(eye.camera).id for eye in anatomy.eyes]
        entry = manifest.caregiver
        assert entry
        self._face_m = np.array(entry.infant_face_m)

    def face_m(self, data: mujoco.MjData) -> FloatArray:
        """Return a point between its eyes, shape (3,)."""
        return data.xpos[self.head] + data.xmat[self.head].reshape(3, 3) @ self._face_m

    def face(self, data: mujoco.MjData) -> tuple[FloatArray, FloatArray]:
        """Return a point between its eyes, shape (3,), and the axes of its head, shape (3, 3)."""
        return self.face_m(data), data.xmat[self.head].reshape(3, 3).copy()

    def gaze(self, data: mujoco.MjData) -> tuple[FloatArray, FloatArray]:
        """Return where it looks from and to: the mean of its eyes, or where its head points to."""
        if not self._cameras:
            place_m, turn = self.face(data)
            return place_m, turn[:, 0]
        way = -data.cam_xmat[self._cameras].reshape(-1, 3, 3)[:, :, 2].mean(axis=0)
        return data.cam_xpos[self._cameras].mean(axis=0), way / np.linalg.norm(way)

    def leg_lengths_m(self, data: mujoco.MjData) -> list[float]:
        """Return the distance from hip to foot of each leg."""
        return [math.dist(data.xpos[foot], data.xpos[hip]) for hip, foot in self.legs]


class Onsets:
    """Tells when the infant begins to do something that can be answered: kick, look, speak or touch.

    A leg kicks when it has got longer by *kick_m* since it was shortest, and can kick again once it has got shorter by
    as much. A look begins when gaze has been at the face for a while; the voice with a sound of it; touch with a
    contact.
    """

    def __init__(self, to: str, infant: Infant, kick_m: float, timestep_s: float):
        self._begins: Callable[[mujoco.MjData, FloatArray, bool], bool] = {
            "kick": self._kicks,
            "gaze": self._looks,
            "vocalisation": self._speaks,
            "touch": self._touches,
        }[to]
        self._infant, self._kick_m, self._timestep_s = infant, kick_m, timestep_s
        self._sources: SoundSources | None = None
        self._voice: Voice | None = None
        self.reset()

    def reset(self) -> None:
        """Begin an episode."""
        self.state: dict[str, Any] = {"legs": [[False, None] for _ in self._infant.legs], "since": 0, "heard": -1}
        """What it remembers: of each leg, whether it is extended and its extreme length since; for how many steps the
        infant has looked or touched, or whether it is loud; the latest physics step with a sound."""

    def listen_to(self, sources: SoundSources, voice: Voice | None) -> None:
        """Hear these sources and the infant's own voice."""
        self._sources, self._voice = sources, voice

    def __call__(self, data: mujoco.MjData, face_m: FloatArray, is_touched: bool) -> bool:
        """Return whether it begins in the last physics step; *is_touched* says whether infant and caregiver touch."""
        return self._begins(data, face_m, is_touched)

    def _kicks(self, data: mujoco.MjData, face_m: FloatArray, is_touched: bool) -> bool:
        begins = False
        for leg, length_m in zip(self.state["legs"], self._infant.leg_lengths_m(data), strict=True):
            is_long, extreme_m = leg
            extreme_m = length_m if extreme_m is None else (max if is_long else min)(extreme_m, length_m)
            if abs(length_m - extreme_m) >= self._kick_m:
                begins |= not is_long
                is_long, extreme_m = not is_long, length_m
            leg[:] = is_long, extreme_m
        return begins

    def _looks(self, data: mujoco.MjData, face_m: FloatArray, is_touched: bool) -> bool:
        place_m, way = self._infant.gaze(data)
        to_face = (face_m - place_m) / np.linalg.norm(face_m - place_m)
        angle_rad, since = math.acos(min(max(float(way @ to_face), -1.0), 1.0)), self.state["since"]
        least = round(LOOK_S / self._timestep_s)
        if angle_rad <= LOOKING_RAD or (since >= least and angle_rad <= LOOKED_AWAY_RAD):
            self.state["since"] = since + 1
        else:
            self.state["since"] = 0
        return self.state["since"] == least

    def _touches(self, data: mujoco.MjData, face_m: FloatArray, is_touched: bool) -> bool:
        self.state["since"] = self.state["since"] + 1 if is_touched else 0
        return self.state["since"] == 1

    def _speaks(self, data: mujoco.MjData, face_m: FloatArray, is_touched: bool) -> bool:
        sounds = self._sources.sounds(data) if self._sources else ()
        voices = [item.start_step for item in sounds if item.kind == "voice" and item.source != "caregiver"]
        latest = max(voices, default=-1)
        is_loud = self._voice is not None and self._voice.level_db > SPOKEN_DB
        begins = latest > self.state["heard"] or (is_loud and not self.state["since"])
        self.state |= {"heard": max(latest, self.state["heard"]), "since": int(is_loud)}
        return begins
