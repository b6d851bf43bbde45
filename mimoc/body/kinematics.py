"""Where the parts of a body are in a given pose, and where it touches the ground."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import numpy.typing as npt

from mimoc.body.tree import Body, BodyTree, Geom, Joint, Vec3
from mimoc.units import deg_to_rad

FloatArray = npt.NDArray[np.float64]
Frame = tuple[FloatArray, FloatArray]
"""Origin and rotation."""


@dataclass(frozen=True)
class Posed:
    """The geoms of a body in a pose, in the frame of its hip."""

    geoms: tuple[Geom, ...]
    centres: FloatArray
    """Shape (n, 3), [m]."""
    turns: FloatArray
    """Hip from geom, shape (n, 3, 3)."""

    @property
    def centre_of_mass(self) -> FloatArray:
        """Shape (3,), [m]; exact, for every geom is symmetric."""
        masses = np.array([geom.mass_kg for geom in self.geoms])
        return masses @ self.centres / masses.sum()

    @property
    def solid(self) -> "Posed":
        """The same without the geoms that collide with nothing."""
        kept = [index for index, geom in enumerate(self.geoms) if geom.contype or geom.conaffinity]
        return Posed(tuple(self.geoms[index] for index in kept), self.centres[kept], self.turns[kept])

    def extent(self, direction: FloatArray) -> float:
        """Return how far the body reaches from the hip along a unit vector of the hip frame, in [m]."""
        local = np.einsum("nij,i->nj", self.turns, direction)
        return float(np.max(self.centres @ direction + reach(self.geoms, local)))


def pose(tree: BodyTree, angles_rad: Mapping[str, float]) -> Posed:
    """Return the body with some joints turned; joints that are not named stay at zero."""
    placed = frames(tree, angles_rad)
    geoms, centres, turns = [], [], []
    for body in tree.bodies:
        origin, turn = placed[body.name]
        for geom in body.geoms:
            geoms.append(geom)
            centres.append(origin + turn @ geom.pos_m)
            turns.append(turn @ euler_matrix(geom.euler_deg))
    return Posed(tuple(geoms), np.array(centres), np.array(turns))


def frames(tree: BodyTree, angles_rad: Mapping[str, float]) -> dict[str, Frame]:
    """Return origin and rotation of every part in the frame of the hip, shapes (3,) and (3, 3).

    Joints that are not named stay at zero.
    """
    found: dict[str, Frame] = {}
    for body in tree.bodies:
        parent = found[body.parent] if body.parent else (np.zeros(3), np.eye(3))
        found[body.name] = _frame(body, angles_rad, *parent)
    return found


def hinges(tree: BodyTree, angles_rad: Mapping[str, float]) -> dict[str, Frame]:
    """Return the anchor and the axis of every joint in the frame of the hip, shapes (3,) each; the axis a unit vector.

    Joints that are not named stay at zero.
    """
    placed, found = frames(tree, angles_rad), {}
    for body in tree.bodies:
        if body.parent:
            for joint, anchor, turn in _turns(body, angles_rad, *placed[body.parent]):
                found[joint.name] = anchor, turn @ joint.axis / np.linalg.norm(joint.axis)
    return found


def frames_in_world(tree: BodyTree, state: Sequence[float]) -> dict[str, Frame]:
    """Return origin and rotation of every part in the world, shapes (3,) and (3, 3).

    Args:
        tree: The body.
        state: Place and quaternion of the hip, then the hinges (qpos).
    """
    hip, turn = hip_in_world(state)
    angles_rad = dict(zip(tree.joints, state[7:], strict=False))
    placed = frames(tree, angles_rad)
    return {name: (hip + turn @ origin, turn @ rotation) for name, (origin, rotation) in placed.items()}


def hip_in_world(state: Sequence[float]) -> Frame:
    """Return place and rotation of the hip, shapes (3,) and (3, 3), of a state (qpos)."""
    x, y, z, w, *axis = state[:7]
    sine = math.hypot(*axis)
    return np.array([x, y, z]), axis_matrix(axis, 2 * math.atan2(sine, w)) if sine else np.eye(3)


def quaternion(rotation: FloatArray) -> tuple[float, float, float, float]:
    """Return a rotation, shape (3, 3), as a unit quaternion w, x, y, z with its first number that is not 0 positive.

    Its largest number is worked out first, from the diagonal, and the others by dividing by it (Shepperd 1978).
    """
    (xx, xy, xz), (yx, yy, yz), (zx, zy, zz) = rotation.tolist()
    rows = (
        (1 + xx + yy + zz, zy - yz, xz - zx, yx - xy),
        (zy - yz, 1 + xx - yy - zz, xy + yx, xz + zx),
        (xz - zx, xy + yx, 1 - xx + yy - zz, yz + zy),
        (yx - xy, xz + zx, yz + zy, 1 - xx - yy + zz),
    )
    largest = max(range(4), key=lambda index: rows[index][index])
    length = math.copysign(math.hypot(*rows[largest]), next(number for number in rows[largest] if abs(number) > 1e-12))
    w, x, y, z = (number / length for number in rows[largest])
    return w, x, y, z


def reach(geoms: Sequence[Geom], directions: FloatArray) -> FloatArray:
    """Return how far each geom reaches from its centre, in [m], shape (n,).

    A box reaches by its edges, a capsule by its axis and its radius everywhere, a cylinder by its
    axis and its disc.

    Args:
        geoms: The n geoms.
        directions: Unit vectors in the frame of each geom, shape (n, 3).
    """
    edges, balls, discs = (np.array(column) for column in zip(*map(_extent, geoms), strict=True))
    along = np.abs(directions)
    return (along * edges).sum(axis=1) + balls + discs * np.sqrt(np.maximum(0.0, 1 - along[:, 2] ** 2))


def _extent(geom: Geom) -> tuple[tuple[float, ...], float, float]:
    """Return the half edges, the radius of the ball and the radius of the disc that make up a geom."""
    if geom.type == "box":
        return geom.size_m, 0.0, 0.0
    if geom.type == "sphere":
        return (0.0, 0.0, 0.0), geom.size_m[0], 0.0
    radius_m, half_m = geom.size_m
    return (0.0, 0.0, half_m), *((radius_m, 0.0) if geom.type == "capsule" else (0.0, radius_m))


@cache
def euler_matrix(euler_deg: Vec3) -> FloatArray:
    """Return the rotation of intrinsic x-y-z angles, shape (3, 3), read-only."""
    x, y, z = (axis_matrix(axis, deg_to_rad(angle)) for axis, angle in zip(np.eye(3), euler_deg, strict=True))
    matrix = x @ y @ z
    matrix.flags.writeable = False
    return matrix


def axis_matrix(axis: npt.ArrayLike, angle_rad: float) -> FloatArray:
    """Return the rotation about an axis of any length, shape (3, 3) (Rodrigues)."""
    x, y, z = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + np.sin(angle_rad) * cross + (1 - np.cos(angle_rad)) * cross @ cross


def _frame(
    body: Body, angles_rad: Mapping[str, float], parent_origin: FloatArray, parent_turn: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return origin and rotation of a body: its joints turn it one after another about their anchors."""
    origin = parent_origin + parent_turn @ body.pos_m
    turn = parent_turn @ euler_matrix(body.euler_deg)
    for joint in body.joints:
        angle_rad = angles_rad.get(joint.name, 0.0)
        if angle_rad:
            anchor = origin + turn @ joint.anchor_m
            turn = turn @ axis_matrix(joint.axis, angle_rad)
            origin = anchor - turn @ joint.anchor_m
    return origin, turn


def _turns(
    body: Body, angles_rad: Mapping[str, float], parent_origin: FloatArray, parent_turn: FloatArray
) -> Iterator[tuple[Joint, FloatArray, FloatArray]]:
    """Yield each joint of a body, where its anchor is, and how the body is turned before it turns."""
    for count, joint in enumerate(body.joints):
        before = replace(body, joints=body.joints[:count])
        origin, turn = _frame(before, angles_rad, parent_origin, parent_turn)
        yield joint, origin + turn @ joint.anchor_m, turn
