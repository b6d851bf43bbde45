"""Frames: sites, cameras and bodies that objectives control, with poses and motion, and the limbs they are on."""

from collections.abc import Collection
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.errors import UnknownNameError
from mimoc.bundle.manifest import AnatomyEntry
from mimoc.runtime.sense import FloatArray

X_AXIS, VIEW = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, -1.0])
"""Pointing axes: x for bodies of infants, and -z for MuJoCo's cameras."""

KINDS = {
    "site": (mujoco.mjtObj.mjOBJ_SITE, "site_bodyid", "site_xpos", "site_xmat", X_AXIS),
    "camera": (mujoco.mjtObj.mjOBJ_CAMERA, "cam_bodyid", "cam_xpos", "cam_xmat", VIEW),
    "body": (mujoco.mjtObj.mjOBJ_BODY, None, "xipos", "xmat", X_AXIS),
}
"""By what a name can be the name of, in the order of looking: where MuJoCo keeps its body, place and axes, and which
way it points. A body is where its centre of mass is, which of a hand is its palm."""


@dataclass(frozen=True, slots=True)
class Motion:
    """Pose and motion of a frame, in the world."""

    place_m: FloatArray
    """Shape (3,)."""
    axes: FloatArray
    """Its axes as columns, shape (3, 3)."""
    pointing: FloatArray
    """Its pointing axis, in its own frame, shape (3,)."""
    velocity: FloatArray
    """Linear, then angular velocity, shape (6,), [m/s, rad/s]."""
    jacobian: FloatArray
    """Jacobian of that velocity, shape (6, nv)."""
    drift: FloatArray
    """Its derivative at zero joint acceleration, shape (6,), [m/s², rad/s²]."""


@dataclass(frozen=True, slots=True)
class Frame:
    """A site, a camera or a body."""

    kind: str
    index: int
    """Index in the model, among its kind."""
    body: int
    """Index of the body that it is attached to."""

    def place_m(self, data: mujoco.MjData) -> FloatArray:
        """Return its position in the world, shape (3,), [m]."""
        return getattr(data, KINDS[self.kind][2])[self.index]

    def motion(self, model: mujoco.MjModel, data: mujoco.MjData) -> Motion:
        """Return its pose and motion; *data* must be up to date with its positions and velocities."""
        _, _, _, axes, pointing = KINDS[self.kind]
        place_m = self.place_m(data)
        rates = np.empty((12, model.nv))
        mujoco.mj_jac(model, data, rates[:3], rates[3:6], place_m, self.body)
        mujoco.mj_jacDot(model, data, rates[6:9], rates[9:], place_m, self.body)
        velocity_and_drift = rates @ data.qvel
        return Motion(
            place_m=place_m.copy(),
            axes=getattr(data, axes)[self.index].reshape(3, 3).copy(),
            pointing=pointing,
            velocity=velocity_and_drift[:6],
            jacobian=rates[:6],
            drift=velocity_and_drift[6:],
        )


def find_frame(name: str, model: mujoco.MjModel, prefix: str = "") -> Frame:
    """Return the site, camera or body of this name, in this order of precedence, or raise an UnknownNameError.

    The name is that in the model, or, of a part of the infant, without *prefix*; these come first.
    """
    for full_name in dict.fromkeys((prefix + name, name)):
        for kind, (object_type, bodies, *_) in KINDS.items():
            index = mujoco.mj_name2id(model, object_type, full_name)
            if index >= 0:
                return Frame(kind, index, int(getattr(model, bodies)[index]) if bodies else index)
    sites = [model.site(index).name for index in range(model.nsite)]
    cameras = [model.camera(index).name for index in range(model.ncam)]
    names = [*sites, *cameras, *(model.body(index).name for index in range(1, model.nbody))]
    raise UnknownNameError("site, camera or body of this infant", name, names)


def trunk_of(anatomy: AnatomyEntry, model: mujoco.MjModel) -> tuple[int, ...]:
    """Return the bodies of the trunk, from the first to the last."""
    return tuple(model.body(name).id for name in anatomy.trunk)


def limb_of(body: int, trunk: Collection[int], model: mujoco.MjModel) -> int:
    """Return the first body of the limb that a body belongs to; 0, the world, for bodies that are not in a limb."""
    while body not in trunk and body:
        parent = int(model.body_parentid[body])
        if parent in trunk:
            return body
        body = parent
    return 0


def joints_between(model: mujoco.MjModel, body: int, root: int) -> list[int]:
    """Return the joints that move a body relative to the parent of *root*, its ancestor or itself."""
    joints: list[int] = []
    while True:
        first, count = int(model.body_jntadr[body]), int(model.body_jntnum[body])
        joints = [*range(first, first + count), *joints]
        if body == root:
            return joints
        body = int(model.body_parentid[body])
