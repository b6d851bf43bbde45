"""Objects that a reset puts elsewhere: the option `objects`."""

import math
from collections.abc import Callable, Mapping

import mujoco
import numpy as np

from mimoc.base.geometry.reach import STRETCHED, leaning_reach, places_around
from mimoc.base.geometry.rotations import Quaternion, quaternion_from_axis, quaternion_product
from mimoc.base.units import cm_to_m
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import TOUCH_M
from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.sense import FloatArray
from mimoc.schema.objects import Move, NewPlace

STEP_M, DIRECTIONS = 0.01, 16  # Step and number of directions of the search for a free place within reach.

Pose = tuple[FloatArray, Quaternion]  # Position in the world, shape (3,), and orientation.
NOWHERE: Mapping[str, Pose] = {}  # No object is anywhere else than it was built.


class Objects:
    """The objects of a scene, bound to a model."""

    def __init__(self, manifest: Manifest, model: mujoco.MjModel):
        self._manifest, self._model = manifest, model
        self._entries = {item.name: item for item in manifest.objects}
        self._bodies = {item.name: int(model.body(item.body).id) for item in manifest.objects}
        self._free = {
            item.name: int(model.joint(item.joint).qposadr[0])
            for item in manifest.objects
            if item.motion == "free" and item.joint
        }
        self._ribbons = {item.name: int(model.tendon(item.ribbon).id) for item in manifest.objects if item.ribbon}
        held = [body for name, body in self._bodies.items() if name not in self._free]
        self._rows = {"body_pos": held, "body_quat": held, "tendon_range": [*self._ribbons.values()]}
        self._built = {name: getattr(model, name)[rows].copy() for name, rows in self._rows.items()}

    @property
    def model_fields(self) -> tuple[ModelField, ...]:
        """What moving them changes in the model."""
        fields = (ModelField(name, np.array(rows, np.intp)) for name, rows in self._rows.items() if rows)
        return tuple(fields)

    def start(self, data: mujoco.MjData, poses: Mapping[str, Pose]) -> None:
        """Move objects in a state that is a keyframe, put all others where they were built, and tie ribbons."""
        self._write(self._built)
        if not poses:
            return
        for name, pose in poses.items():
            self._put(name, pose, data)
        mujoco.mj_kinematics(self._model, data)
        mujoco.mj_comPos(self._model, data)
        mujoco.mj_tendon(self._model, data)
        for name, ribbon in self._ribbons.items():
            if name in poses:
                self._model.tendon_range[ribbon, 1] = data.ten_length[ribbon] + self._entries[name].slack_m

    def stay(self, former: "Objects") -> None:
        """Keep the places of objects that are not free from the same infant at another age."""
        self._write({name: getattr(former._model, name)[rows] for name, rows in former._rows.items()})

    def find_poses(
        self, start: Callable[[mujoco.MjData], None], moves: Mapping[str, Move], earlier: Mapping[str, Pose] = NOWHERE
    ) -> dict[str, Pose]:
        """Return the poses of objects that are moved one after another, without changing anything."""
        if not moves:
            return {}
        model, data = self._model, mujoco.MjData(self._model)
        before = {name: getattr(model, name)[rows].copy() for name, rows in self._rows.items()}
        poses = dict[str, Pose]()
        try:
            start(data)
            self._write(self._built)
            for name, pose in earlier.items():
                self._put(name, pose, data)
            for name, move in moves.items():
                mujoco.mj_kinematics(model, data)
                poses[name] = self._pose(name, move, data)
                self._put(name, poses[name], data)
            for name in moves:
                if other := self._touched(name, data):
                    raise ValueError(f"object '{name}' would be inside of '{other}'; give it another place")
        finally:
            self._write(before)
        return poses

    def _write(self, arrays: Mapping[str, FloatArray]) -> None:
        for name, rows in self._rows.items():
            getattr(self._model, name)[rows] = arrays[name]

    def _put(self, name: str, pose: Pose, data: mujoco.MjData) -> None:
        body, (pos_m, quat) = self._bodies[name], pose
        if name in self._free:
            address = self._free[name]
            data.qpos[address : address + 7] = (*pos_m, *quat)
        else:
            self._model.body_pos[body], self._model.body_quat[body] = pos_m, quat

    def _pose(self, name: str, move: Move, data: mujoco.MjData) -> Pose:
        entry, body = self._entries[name], self._bodies[name]
        w, x, y, z = data.xquat[body].tolist()
        if isinstance(move, NewPlace):
            height_m = cm_to_m(move.z_cm) + entry.origin_m
            turn = quaternion_from_axis((0.0, 0.0, 1.0), math.radians(move.yaw_deg))
            place_m = np.array([cm_to_m(move.x_cm), cm_to_m(move.y_cm), height_m])
            return place_m, quaternion_product(turn, (w, x, y, z))
        relation, other = move
        place_m = self._on(name, other, data) if relation == "on" else self._within_reach(name, other, data)
        return place_m, (w, x, y, z)

    def _on(self, name: str, other: str, data: mujoco.MjData) -> FloatArray:
        below = self._entries.get(other)
        if below is None or below.surface_m is None or other == name:
            raise ValueError(f"object '{name}': there is no object '{other}' with a level top to lie on")
        place_m = data.xpos[self._bodies[other]].copy()
        place_m[2] += below.height_m - below.origin_m + self._entries[name].origin_m
        return place_m

    def _within_reach(self, name: str, hand: str, data: mujoco.MjData) -> FloatArray:
        """Return the nearest free place on the floor within reach of a hand; in the air for what does not lie."""
        arms = {arm.end: arm for arm in self._manifest.anatomy.arms if arm.end}
        hand = hand if hand in arms else self._manifest.prefix + hand
        if hand not in arms:
            raise ValueError(f"object '{name}': '{hand}' is no hand of this infant")
        model, entry = self._model, self._entries[name]
        root, end = model.body(arms[hand].root).id, model.body(hand).id
        shoulder_m = data.xpos[root].copy()
        length_m = _length_m(model, root, end)
        if entry.motion not in ("free", "sliding"):
            ahead = data.xmat[model.body(self._manifest.anatomy.trunk[-1]).id].reshape(3, 3)[:, 0]
            return shoulder_m + STRETCHED * length_m * ahead + (0.0, 0.0, entry.origin_m - entry.height_m / 2)
        hip_m = float(data.xpos[model.body(self._manifest.root_body).id][2])
        reach_m = leaning_reach(length_m, float(shoulder_m[2]), hip_m)
        w, x, y, z = data.xquat[self._bodies[name]].tolist()
        x_m, y_m = (data.xpos[end] - shoulder_m)[:2]
        for across_m in places_around(math.atan2(y_m, x_m), 2 * length_m, STEP_M, DIRECTIONS):
            place_m = np.array([*(data.xpos[end][:2] + across_m), entry.origin_m])
            if np.linalg.norm(place_m[:2] - shoulder_m[:2]) > reach_m:
                continue
            self._put(name, (place_m, (w, x, y, z)), data)
            if not self._touched(name, data):
                return place_m
        raise ValueError(f"object '{name}': there is no free place within reach of {hand}; give coordinates")

    def _touched(self, name: str, data: mujoco.MjData) -> str:
        """Return the name of what an object is inside of; empty if it is free."""
        model, body = self._model, self._bodies[name]
        mujoco.mj_kinematics(model, data)
        mujoco.mj_comPos(model, data)
        mujoco.mj_collision(model, data)
        bodies = model.geom_bodyid[data.contact.geom]
        inside = np.isin(model.body_rootid[bodies], [body]) & (data.contact.dist < -TOUCH_M)[:, None]
        for contact in np.flatnonzero(inside.sum(axis=1) == 1):
            geom = int(data.contact.geom[contact][~inside[contact]][0])
            other = int(model.geom_bodyid[geom])
            return model.body(other).name if other else model.geom(geom).name
        return ""


def _length_m(model: mujoco.MjModel, root: int, end: int) -> float:
    """Return an arm's reach from its root: along its bodies, to the end of the last one's geoms."""
    length_m, body = 0.0, end
    while body != root:
        length_m += float(np.linalg.norm(model.body_pos[body]))
        body = int(model.body_parentid[body])
    geoms = np.flatnonzero(model.geom_bodyid == end)
    tips_m = np.linalg.norm(model.geom_pos[geoms], axis=1) + model.geom_rbound[geoms]
    return length_m + float(tips_m.max(initial=0.0))
