"""Motions of a body: the angles of its joints over time, between frames as well, and the files that keep them.

Between frames, places and angles follow cubic splines, and rotations of free joints a spline with continuous angular
acceleration (SciPy's `RotationSpline`); both pass through every frame.
"""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, Self

import mujoco
import numpy as np
import numpy.typing as npt
from scipy.interpolate import CubicSpline
from scipy.spatial.transform import Rotation, RotationSpline

from mimoc.base.errors import BundleError, MimocError
from mimoc.bundle.io import pack_arrays, unpack_arrays
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file
from mimoc.schema.base import Model

FloatArray = npt.NDArray[np.float64]
IntArray = npt.NDArray[np.intp]
MOTION = "motion.npz"  # Name of the file in the folder of a retargeted recording.
MAX_BYTES = 2**28  # Largest size of such a file, unpacked: an hour of 60 joints at 120 Hz has 207 MB.
FREE, HINGE = 7, 1  # Numbers of a configuration that a free joint and a hinge have.
FREE_SPEEDS = 6
TURN = slice(3, 7)  # Where the quaternion of a free joint is among its numbers: w, x, y, z.
FIXED_ORDER = [1, 2, 3, 0]  # From MuJoCo's order of a quaternion to SciPy's.
MAX_S = 7200.0  # Longest motion: its states at all control steps are kept.
MAX_M_OR_RAD = 1e4
UNIT = 0.01  # How far the length of a quaternion may be from 1.
_ADVICE = "write it again with 'mimoc retarget'"


class _About(Model):
    """All of a motion but its numbers, as it stands in the file."""

    rate_hz: float
    joints: tuple[str, ...]
    free: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class States:
    """A motion at n times: configurations, velocities and accelerations, as MuJoCo has them.

    Those of free joints are linear in the world's frame, and angular in the body's.
    """

    qpos: FloatArray  # Shape (n, nq).
    qvel: FloatArray  # Shape (n, nv).
    qacc: FloatArray  # Shape (n, nv).


@dataclass(frozen=True)
class JointMotion:
    """A motion of j joints over t frames.

    Example:
        >>> import numpy as np
        >>> from mimoc.motion.joint_motion import JointMotion
        >>> motion = JointMotion(30.0, ("elbow",), np.sin(np.arange(4.0))[:, None])
        >>> motion.seconds
        0.1
    """

    rate_hz: float
    joints: tuple[str, ...]  # Names of the joints: free joints and hinges.
    qpos: FloatArray
    """Their configurations, one after another, shape (t, nq): 7 numbers of a free joint [m, quaternion], one of a hinge
    [rad]."""
    free: tuple[str, ...] = ()

    @property
    def seconds(self) -> float:
        """Time from the first to the last frame."""
        return (len(self.qpos) - 1) / self.rate_hz

    @cached_property
    def _splines(self) -> list[Any]:
        times_s = np.arange(len(self.qpos)) / self.rate_hz
        splines = list[Any]()
        first = 0
        for joint in self.joints:
            if joint in self.free:
                turns = Rotation.from_quat(self.qpos[:, first : first + FREE][:, TURN][:, FIXED_ORDER])
                splines.append((CubicSpline(times_s, self.qpos[:, first : first + 3]), RotationSpline(times_s, turns)))
                first += FREE
            else:
                splines.append(CubicSpline(times_s, self.qpos[:, first : first + HINGE]))
                first += HINGE
        return splines

    def at(self, times_s: npt.NDArray[Any]) -> States:
        """Return the motion at n times from the first frame on, shape (n,); before and after it, nothing moves on.

        Velocities and accelerations beyond the last frame are zero.
        """
        inside = np.clip(times_s, 0.0, self.seconds)
        moving = (np.asarray(times_s) <= self.seconds)[:, None]
        orders = ([_value(spline, inside, order) for spline in self._splines] for order in range(3))
        qpos, qvel, qacc = (np.concatenate(parts, axis=1) for parts in orders)
        return States(qpos, qvel * moving, qacc * moving)

    def moved_to(self, start: FloatArray) -> Self:
        """Return the same motion elsewhere on the floor: it begins where a configuration of its joints is, (nq,).

        The first joint, which must be free, begins above the same point and faces the same way about the vertical.
        """
        from_rad = _heading_rad(self.qpos[0, TURN])
        to_rad = _heading_rad(start[TURN])
        turn = Rotation.from_rotvec([0.0, 0.0, to_rad - from_rad])
        qpos = self.qpos.copy()
        ways_m = (self.qpos[:, :3] - self.qpos[0, :3]) * [1.0, 1.0, 0.0]
        qpos[:, :2] = start[:2] + turn.apply(ways_m)[:, :2]
        turned = turn * Rotation.from_quat(self.qpos[:, TURN][:, FIXED_ORDER])
        qpos[:, TURN] = turned.as_quat()[:, [3, 0, 1, 2]]
        return type(self)(self.rate_hz, self.joints, qpos, self.free)

    def part(self, stop: int) -> Self:
        """Return the first frames of it."""
        return type(self)(self.rate_hz, self.joints, self.qpos[:stop], self.free)

    def places(self, model: mujoco.MjModel, prefix: str = "") -> tuple[IntArray, IntArray]:
        """Return where its numbers belong in the configuration and in the velocity of an infant, shape (nq,) and (nv,).

        The names of the infant's joints begin with a *prefix* in a model that has others as well.

        Raises:
            MimocError: If the infant lacks one of the joints, or has it of another type.
        """
        qpos, speeds = list[int](), list[int]()
        for name in self.joints:
            joint = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_JOINT, prefix + name)
            is_free = name in self.free
            wanted = mujoco.mjtJoint.mjJNT_FREE if is_free else mujoco.mjtJoint.mjJNT_HINGE
            if joint < 0 or model.jnt_type[joint] != wanted:
                raise MimocError(
                    f"the motion moves the joint '{name}', which this infant does not have; choose an infant with the"
                    " same parts, and one that is not held, as the motion was fitted to"
                )
            qpos += range(model.jnt_qposadr[joint], model.jnt_qposadr[joint] + (FREE if is_free else HINGE))
            speeds += range(model.jnt_dofadr[joint], model.jnt_dofadr[joint] + (FREE_SPEEDS if is_free else HINGE))
        return np.array(qpos, np.intp), np.array(speeds, np.intp)


def motion_of(model: mujoco.MjModel, root_body: str, qpos: FloatArray, rate_hz: float) -> JointMotion:
    """Return the motion of an infant in a model, without that of toys, from whole configurations, shape (t, nq)."""
    root = model.body(root_body).id
    joints = [joint for joint in range(model.njnt) if model.body_rootid[model.jnt_bodyid[joint]] == root]
    free = [joint for joint in joints if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE]
    names = tuple(model.joint(joint).name for joint in joints)
    motion = JointMotion(rate_hz, names, np.zeros((0, 0)), tuple(model.joint(joint).name for joint in free))
    return JointMotion(rate_hz, names, np.ascontiguousarray(qpos[:, motion.places(model)[0]]), motion.free)


def _heading_rad(quaternion: FloatArray) -> float:
    """Return which way a body faces about the vertical: by its leftward axis, horizontal however it is pitched."""
    left = Rotation.from_quat(quaternion[FIXED_ORDER]).apply([0.0, 1.0, 0.0])
    return float(np.arctan2(-left[0], left[1]))


def _value(spline: Any, times_s: FloatArray, order: int) -> FloatArray:
    if isinstance(spline, CubicSpline):
        return spline(times_s, order)
    place, turn = spline
    turned = turn(times_s, order)
    turned = turned.as_quat()[:, [3, 0, 1, 2]] if order == 0 else turned  # Rates are in the body's frame, as MuJoCo's.
    return np.concatenate([place(times_s, order), turned], axis=1)


def pack_motion(motion: JointMotion) -> bytes:
    """Return the content of a file: always the same bytes, and `numpy.load` reads its `qpos`, too."""
    about = _About(rate_hz=motion.rate_hz, joints=motion.joints, free=motion.free).model_dump_json()
    return pack_arrays({"about": np.frombuffer(about.encode(), np.uint8), "qpos": motion.qpos})


def read_motion(path: Path) -> JointMotion:
    """Return the motion in a file, or in the folder of a retargeted recording, or raise a MimocError."""
    file = path / MOTION if path.is_dir() else path
    try:
        content = read_regular_file(file, MAX_BYTES)
    except UnusableFileError as error:
        raise MimocError(f"{file}: {error}; {_ADVICE}") from None
    if content is None:
        raise MimocError(f"{file}: the file does not exist; {_ADVICE}")
    try:
        arrays = unpack_arrays(content)
        about = _About.model_validate_json(arrays["about"].tobytes())
        motion = JointMotion(about.rate_hz, about.joints, np.asarray(arrays["qpos"], np.float64), about.free)
        sizes = [FREE if joint in motion.free else HINGE for joint in motion.joints]
        frames, count = len(motion.qpos), sum(sizes)
        if frames < 2 or motion.qpos.shape != (frames, count) or not 0 < motion.rate_hz < 1e6 or motion.seconds > MAX_S:
            raise ValueError("it has other numbers than its joints need, or is too long")
        if not (np.abs(motion.qpos) <= MAX_M_OR_RAD).all() or len({*motion.joints}) != len(motion.joints):
            raise ValueError("it has a number that is none or too large, or names a joint twice")
        for end, size in zip(np.cumsum(sizes), sizes, strict=True):
            if (
                size == FREE
                and not (np.abs(np.linalg.norm(motion.qpos[:, end - size :][:, TURN], axis=1) - 1) < UNIT).all()
            ):
                raise ValueError("it has a quaternion that is no rotation")
        return motion
    except (BundleError, KeyError, ValueError, TypeError):
        raise MimocError(f"{file}: not a motion, or damaged; give the folder that 'mimoc retarget' wrote") from None
