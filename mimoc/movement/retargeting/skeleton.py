"""Forward kinematics of an infant at many frames at once, with derivatives by its unknowns and by its sizes."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.motion.body_points import BodyPoint
from mimoc.motion.point_recording import FloatArray

IntArray = npt.NDArray[np.intp]
ROOT = 6  # Unknowns of the root, which come first: where it is, then how it is turned.


@dataclass(frozen=True)
class Hinges:
    """The j hinges that are fitted, and the u unknowns that turn them; two lumbar hinges can turn by one unknown."""

    names: tuple[str, ...]  # Names of the unknowns, those of the first hinge that each turns; u of them.
    ids: IntArray  # Joints of the model, shape (j,).
    column: IntArray  # Unknown that turns each hinge, shape (j,).
    factor: FloatArray  # Angle of the hinge over the unknown, shape (j,).


@dataclass(frozen=True)
class Shape:
    """Vectors that the sizes of a body set; the last axis has the vector, then its derivatives by s sizes."""

    bodies_m: FloatArray  # Origins in the frames of the parents, shape (nbody, 3, 1 + s).
    anchors_m: FloatArray  # Anchors of joints in the frames of their bodies, shape (njnt, 3, 1 + s).
    points_m: FloatArray  # Points in the frames of their bodies, shape (k, 3, 1 + s).


@dataclass(frozen=True)
class Pose:
    """Where points are at f frames; components come first."""

    points_m: FloatArray  # Shape (3, f, k, 1 + s): in the world, and derivatives by sizes.
    anchors_m: FloatArray  # Anchors of the hinges, shape (3, f, j).
    axes: FloatArray  # Axes of the hinges, shape (3, f, j).
    root_m: FloatArray  # Shape (3, f).
    turning: FloatArray  # Left Jacobian of the root's rotation vector, shape (3, 3, f): frames last.


class Skeleton:
    """The bodies of a model that carry points, and the hinges between them.

    An unknown vector is [root's position in [m], rotation vector w in [rad], angles of hinges in [rad]]; the root is
    turned by exp([w]) R, with R the same in all frames. So every unknown lies in a vector space, and differences
    between frames are plain differences.
    """

    def __init__(
        self, model: mujoco.MjModel, points: Sequence[BodyPoint], hinges: Hinges, rest: FloatArray, turned: FloatArray
    ):
        """Prepare the chains to some points; unfitted hinges keep *rest*, (nq,); *turned* is R, shape (3, 3)."""
        self.hinges, self.rest, self.turned = hinges, rest.copy(), turned
        self.point_bodies = np.array([point.body for point in points], dtype=np.intp)
        self._model, self._root = model, int(model.jnt_bodyid[0])
        self._bodies = sorted(carrying(model, self.point_bodies.tolist()) - {self._root})
        self._pairs = self._moved()

    @property
    def unknowns(self) -> int:
        """Number of unknowns of a frame, n."""
        return ROOT + len(self.hinges.names)

    def pose(self, x: FloatArray, shape: Shape) -> Pose:
        """Return where everything is, at unknowns of shape (f, n)."""
        model, hinges, frames = self._model, self.hinges, len(x)
        turned, origin = {}, {}
        anchors, axes = np.zeros((len(hinges.ids), frames, 3)), np.zeros((len(hinges.ids), frames, 3))
        rotation, turning = exponential(x[:, 3:ROOT])
        turned[self._root] = rotation @ self.turned
        origin[self._root] = np.zeros((frames, 3, shape.bodies_m.shape[-1]))
        origin[self._root][..., 0] = x[:, :3]
        angle = dict(zip(hinges.ids.tolist(), (x[:, ROOT + hinges.column] * hinges.factor).T, strict=True))
        row = {joint: index for index, joint in enumerate(hinges.ids.tolist())}
        for body in self._bodies:
            parent = int(model.body_parentid[body])
            at = origin[parent] + turned[parent] @ shape.bodies_m[body]
            turn = turned[parent] @ matrix_of(model.body_quat[body])
            for joint in range(model.body_jntadr[body], model.body_jntadr[body] + model.body_jntnum[body]):
                q = angle.get(joint, np.array([self.rest[model.jnt_qposadr[joint]]]))
                at = at + turn @ shape.anchors_m[joint]
                if joint in row:
                    anchors[row[joint]] = at[..., 0]
                    axes[row[joint]] = turn @ model.jnt_axis[joint]
                turn = turn @ about(model.jnt_axis[joint], q - model.qpos0[model.jnt_qposadr[joint]])
                at = at - turn @ shape.anchors_m[joint]
            turned[body], origin[body] = turn, at
        points = np.stack(
            [origin[b] + turned[b] @ v for b, v in zip(self.point_bodies.tolist(), shape.points_m, strict=True)]
        )
        return Pose(
            points.transpose(2, 1, 0, 3),
            anchors.transpose(2, 1, 0),
            axes.transpose(2, 1, 0),
            x[:, :3].T,
            turning.transpose(1, 2, 0),
        )

    def jacobian(self, pose: Pose, points: IntArray, frames: Any = slice(None)) -> FloatArray:
        """Return the derivatives of some points by the unknowns, at some frames, shape (3, f, points, n).

        A hinge with axis a through c moves a point p by a x (p - c) per radian; the root's rotation vector moves it by
        the columns of J_l(w), likewise.
        """
        places = pose.points_m[:, frames][:, :, points, 0]
        result = np.zeros((*places.shape, self.unknowns))
        result[range(3), :, :, range(3)] = 1.0
        arms = places - pose.root_m[:, frames, None]
        for column in range(3):
            result[..., 3 + column] = cross(pose.turning[:, column, frames, None], arms)
        for point, joint, column, factor in self._pairs:
            chosen = np.isin(point, points)
            if not chosen.any():
                continue
            place = np.searchsorted(points, point[chosen]) if len(points) > 1 else np.zeros(chosen.sum(), np.intp)
            j = joint[chosen]
            arm = places[:, :, place] - pose.anchors_m[:, frames][:, :, j]
            result[:, :, place, column[chosen]] += factor[chosen] * cross(pose.axes[:, frames][:, :, j], arm)
        return result

    def points_moved(self, columns: IntArray) -> IntArray:
        """Return the points that some unknowns move, as indices."""
        moved = [point[np.isin(column, columns)] for point, _, column, _ in self._pairs]
        return np.unique(np.concatenate(moved))

    def qpos(self, x: FloatArray) -> FloatArray:
        """Return configurations of the model, shape (f, nq)."""
        result = np.repeat(self.rest[None], len(x), axis=0)
        result[:, :3] = x[:, :3]
        result[:, 3:7] = [quaternion_of(r @ self.turned) for r in exponential(x[:, 3:ROOT])[0]]
        joints = self._model.jnt_qposadr[self.hinges.ids]
        result[:, joints] = x[:, ROOT + self.hinges.column] * self.hinges.factor
        return result

    def _moved(self) -> list[tuple[IntArray, IntArray, IntArray, FloatArray]]:
        """Return which hinge moves which point, in groups without two hinges of one unknown: indices and factors."""
        groups: list[list[tuple[int, int, int, float]]] = [[], []]
        bodies = self._model.jnt_bodyid[self.hinges.ids].tolist()
        for point, end in enumerate(self.point_bodies.tolist()):
            chain, seen = set(), set()
            while end:
                chain.add(end)
                end = int(self._model.body_parentid[end])
            for joint, body in enumerate(bodies):
                column = ROOT + int(self.hinges.column[joint])
                if body in chain:
                    groups[column in seen].append((point, joint, column, float(self.hinges.factor[joint])))
                    seen.add(column)
        tables = [np.array(group) for group in groups if group]
        indices = [table[:, :3].astype(np.intp).T for table in tables]
        return [(index[0], index[1], index[2], table[:, 3]) for index, table in zip(indices, tables, strict=True)]


def carrying(model: mujoco.MjModel, bodies: Iterable[int]) -> set[int]:
    """Return some bodies and all that they hang on, but the world."""
    result: set[int] = set()
    for body in bodies:
        while body:
            result.add(body)
            body = int(model.body_parentid[body])
    return result


def cross(a: FloatArray, b: FloatArray) -> FloatArray:
    """Return the cross product of arrays whose first axis has the components."""
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def about(axis: FloatArray, angle: FloatArray) -> FloatArray:
    """Return rotation matrices about an axis by f angles (Rodrigues), shape (f, 3, 3)."""
    generator = skew(axis)
    sine = np.sin(angle)[:, None, None]
    versine = (1 - np.cos(angle))[:, None, None]
    return np.eye(3) + sine * generator + versine * (generator @ generator)


def exponential(vectors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return rotation matrices exp([w]) of f rotation vectors w, and their left Jacobians, both (f, 3, 3).

    With angle a = |w|: exp([w]) = 1 + sin(a)/a [w] + (1 - cos a)/a^2 [w]^2, and
    J_l = 1 + (1 - cos a)/a^2 [w] + (a - sin a)/a^3 [w]^2; exp([w + d]) = exp([J_l d]) exp([w]) to first order in d.
    """
    angle = np.maximum(np.linalg.norm(vectors, axis=1), 1e-8)[:, None, None]
    generator = skew(vectors)
    square = generator @ generator
    first = np.sin(angle) / angle
    second = 2 * (np.sin(angle / 2) / angle) ** 2
    third = np.where(angle < 1e-2, 1 / 6 - angle**2 / 120, (angle - np.sin(angle)) / angle**3)
    return np.eye(3) + first * generator + second * square, np.eye(3) + second * generator + third * square


def skew(vectors: FloatArray) -> FloatArray:
    """Return the matrices [w] with [w] v = w x v, shape (..., 3, 3)."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    zero = np.zeros_like(x)
    return np.stack([np.stack([zero, -z, y], -1), np.stack([z, zero, -x], -1), np.stack([-y, x, zero], -1)], -2)


def rotation_vector(matrix: FloatArray) -> FloatArray:
    """Return the rotation vector of a rotation matrix, shape (3,), of length up to pi."""
    quaternion, vector = quaternion_of(matrix), np.zeros(3)
    mujoco.mju_quat2Vel(vector, quaternion, 1.0)
    return vector


def quaternion_of(matrix: FloatArray) -> FloatArray:
    """Return the unit quaternion of a rotation matrix."""
    quaternion = np.zeros(4)
    mujoco.mju_mat2Quat(quaternion, np.ascontiguousarray(matrix).ravel())
    return quaternion


def matrix_of(quaternion: FloatArray) -> FloatArray:
    """Return the rotation matrix of a unit quaternion."""
    matrix = np.zeros(9)
    mujoco.mju_quat2Mat(matrix, quaternion)
    return matrix.reshape(3, 3)


NEVER = "eye", "fingers", "toe", "_ff_", "_mf_", "_rf_", "_lf_", "_th_"
"""Parts of names of hinges that no point tells of."""


def hinges_of(model: mujoco.MjModel, points: Sequence[BodyPoint]) -> Hinges:
    """Return the hinges between the root and some points, parents first.

    The lumbar hinges of two bodies that MIMo couples by tendons of (nearly) fixed length turn by one unknown.
    """
    bodies = carrying(model, [point.body for point in points])
    followers = _followers(model)
    names, ids, columns, factors = [], [], [], []
    for joint in range(1, model.njnt):
        name = model.joint(joint).name
        hinge = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE
        if not hinge or int(model.jnt_bodyid[joint]) not in bodies or any(part in name for part in NEVER):
            continue
        leader, factor = followers.get(joint, (joint, 1.0))
        if leader not in ids and leader != joint:
            continue
        if leader == joint:
            names.append(name)
        ids.append(joint)
        columns.append(names.index(model.joint(leader).name))
        factors.append(factor)
    return Hinges(tuple(names), np.array(ids, np.intp), np.array(columns, np.intp), np.array(factors))


def combined_limits(model: mujoco.MjModel, hinges: Hinges) -> tuple[np.ndarray, np.ndarray]:
    """Return the limits of sums of unknowns that tendons set: factors, shape (m, u), and bounds, shape (m,)."""
    factors, bounds = [], []
    place = dict(zip(hinges.ids.tolist(), hinges.column.tolist(), strict=True))
    followers = _followers(model)
    for tendon in range(model.ntendon):
        joints, weights = _terms(model, tendon)
        if model.tendon_limited[tendon] and all(j in place and j not in followers for j in joints):
            if set(joints) & {leader for leader, _ in followers.values()}:
                continue
            row = np.zeros(len(hinges.names))
            row[[place[j] for j in joints]] = weights
            factors.append(row)
            bounds.append(float(np.abs(model.tendon_range[tendon]).min()))
    return np.array(factors).reshape(-1, len(hinges.names)), np.array(bounds)


def _followers(model: mujoco.MjModel) -> dict[int, tuple[int, float]]:
    """Return the hinges that tendons of nearly fixed length turn with another: which other, and by how much."""
    followers = {}
    for tendon in range(model.ntendon):
        joints, weights = _terms(model, tendon)
        if len(joints) == 2 and model.tendon_limited[tendon] and np.ptp(model.tendon_range[tendon]) < 0.1:
            followers[joints[1]] = (joints[0], -weights[0] / weights[1])
    return followers


def _terms(model: mujoco.MjModel, tendon: int) -> tuple[list[int], list[float]]:
    """Return the joints and factors of a tendon that is a sum of angles; none of another."""
    span = slice(model.tendon_adr[tendon], model.tendon_adr[tendon] + model.tendon_num[tendon])
    if (model.wrap_type[span] != mujoco.mjtWrap.mjWRAP_JOINT).any():
        return [], []
    return model.wrap_objid[span].tolist(), model.wrap_prm[span].tolist()
