"""Forward kinematics of a body, its extents in a pose, and its stature, for comparison with growth standards."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TypedDict

import numpy as np

from mimoc.base.geometry.primitives import Extents, extents, girth
from mimoc.base.geometry.rotations import (
    FloatArray,
    Vec3,
    matrices_from_axes,
    matrix_from_axis,
    matrix_from_euler,
    matrix_from_quaternion,
)
from mimoc.base.units import m_to_cm
from mimoc.body.tree import Body, BodyTree, Geom, Joint

Frame = tuple[FloatArray, FloatArray]  # Origin and rotation.


@dataclass(frozen=True)
class Posed:
    """The n geoms of a body in a pose, or in each of several, in the frame of its hip."""

    geoms: tuple[Geom, ...]
    centres: FloatArray  # Shape (..., n, 3), [m].
    rotations: FloatArray  # Hip from geom, shape (..., n, 3, 3).

    @property
    def centre_of_mass(self) -> FloatArray:
        """Centre of mass, shape (..., 3), [m]; exact, because every geom is symmetric."""
        masses = np.array([geom.mass_kg for geom in self.geoms])
        return masses @ self.centres / masses.sum()

    @property
    def solid(self) -> "Posed":
        """This pose without the geoms that have no contacts."""
        return self.only([index for index, geom in enumerate(self.geoms) if geom.contype or geom.conaffinity])

    @property
    def extents(self) -> Extents:
        """Extents of each geom from its own centre."""
        return extents((geom.type, geom.size_m) for geom in self.geoms)

    def only(self, kept: Sequence[int]) -> "Posed":
        """Return this pose with only some of the geoms, by index."""
        geoms = tuple(self.geoms[index] for index in kept)
        return Posed(geoms, self.centres[..., kept, :], self.rotations[..., kept, :, :])

    def reaches(self, direction: FloatArray) -> FloatArray:
        """Return each geom's extent from the hip along a unit vector of the hip frame, shape (n,), [m]."""
        local = np.einsum("nij,i->nj", self.rotations, direction)
        return self.centres @ direction + self.extents.along(local)

    def extent(self, direction: FloatArray) -> float:
        """Return the body's extent from the hip along a unit vector of the hip frame, in [m]."""
        return float(self.reaches(direction).max())


def pose(tree: BodyTree, angles_rad: Mapping[str, float]) -> Posed:
    """Return the body with some joint angles; joints that are not named are at zero."""
    return _posed(tree, frames(tree, angles_rad))


def pose_all(tree: BodyTree, poses_rad: Sequence[Mapping[str, float]]) -> Posed:
    """Return what `pose` does, to the bit, of p poses at once; arrays have p as their first axis."""
    count, joints = len(poses_rad), tree.joints
    angles = [[angles_rad.get(name, 0.0) for angles_rad in poses_rad] for name in joints]
    rotations = matrices_from_axes([joint.axis for joint in joints.values()], angles)
    turns = dict(zip(joints, zip(angles, rotations, strict=True), strict=True))
    placed: dict[str | None, Frame] = {None: (np.zeros((count, 3)), np.broadcast_to(np.eye(3), (count, 3, 3)))}
    for body in tree.bodies:
        origin, turn = placed[body.parent]
        origin = origin + turn @ body.pos_m
        turn = turn @ matrix_from_euler(body.euler_deg)
        for joint in body.joints:
            angles_rad, rotation = turns[joint.name]
            turned = [index for index, angle in enumerate(angles_rad) if angle]
            if turned:
                anchor_m, before = np.array(joint.anchor_m), turn[turned]
                turn[turned] = after = before @ rotation[turned]
                origin[turned] = origin[turned] + before @ anchor_m - after @ anchor_m
        placed[body.name] = origin, turn
    return _posed(tree, {body.name: placed[body.name] for body in tree.bodies})


def _posed(tree: BodyTree, placed: Mapping[str, Frame]) -> Posed:
    geoms = tuple(geom for body in tree.bodies for geom in body.geoms)
    homes = [placed[body.name] for body in tree.bodies for _ in body.geoms]
    origins = np.stack([origin for origin, _ in homes], axis=-2)
    turns = np.stack([turn for _, turn in homes], axis=-3)
    places = np.array([geom.pos_m for geom in geoms])
    tilts = np.array([matrix_from_euler(geom.euler_deg) for geom in geoms])
    return Posed(geoms, origins + (turns @ places[:, :, None])[..., 0], turns @ tilts)


def frames(tree: BodyTree, angles_rad: Mapping[str, float]) -> dict[str, Frame]:
    """Return origin and rotation of every part in the frame of the hip, shapes (3,) and (3, 3).

    Joints that are not named are at zero.
    """
    return {body.name: (origin, turn) for body, joint, origin, turn in _walk(tree, angles_rad) if joint is None}


def hinges(tree: BodyTree, angles_rad: Mapping[str, float]) -> dict[str, Frame]:
    """Return the anchor and the axis of every joint in the frame of the hip, shapes (3,) each; the axis a unit vector.

    Joints that are not named are at zero.
    """
    return {
        joint.name: (origin + turn @ joint.anchor_m, turn @ joint.axis / np.linalg.norm(joint.axis))
        for _, joint, origin, turn in _walk(tree, angles_rad)
        if joint
    }


def _walk(
    tree: BodyTree, angles_rad: Mapping[str, float]
) -> Iterator[tuple[Body, Joint | None, FloatArray, FloatArray]]:
    """Yield origin and rotation of each body before each of its joints turns it about its anchor, and after the last.

    Then there is None instead of a joint.
    """
    placed: dict[str | None, Frame] = {None: (np.zeros(3), np.eye(3))}
    for body in tree.bodies:
        origin, turn = placed[body.parent]
        origin = origin + turn @ body.pos_m
        turn = turn @ matrix_from_euler(body.euler_deg)
        for joint in body.joints:
            yield body, joint, origin, turn
            if angle_rad := angles_rad.get(joint.name, 0.0):
                anchor = origin + turn @ joint.anchor_m
                turn = turn @ matrix_from_axis(joint.axis, angle_rad)
                origin = anchor - turn @ joint.anchor_m
        placed[body.name] = origin, turn
        yield body, None, origin, turn


def frames_in_world(tree: BodyTree, state: Sequence[float]) -> dict[str, Frame]:
    """Return origin and rotation of every part in the world, shapes (3,) and (3, 3), from qpos."""
    hip, turn = hip_in_world(state)
    angles_rad = dict(zip(tree.joints, state[7:], strict=False))
    placed = frames(tree, angles_rad)
    return {name: (hip + turn @ origin, turn @ rotation) for name, (origin, rotation) in placed.items()}


def hip_in_world(state: Sequence[float]) -> Frame:
    """Return position and rotation of the hip, shapes (3,) and (3, 3), from a state (qpos)."""
    return np.array(state[:3]), matrix_from_quaternion(state[3:7])


def body_reaches(tree: BodyTree, state: Sequence[float], direction: Vec3) -> dict[str, float]:
    """Return how far each body reaches along a direction of the world in a state, from the world's origin, in [m]."""
    origin_m, turn = hip_in_world(state)
    posed = pose(tree, dict(zip(tree.joints, state[7:], strict=True)))
    reaches_m = posed.reaches(turn.T @ np.array(direction)) + float(origin_m @ np.array(direction))
    owners = [body.name for body in tree.bodies for _ in body.geoms]
    return {
        owner: max(reach for reach, other in zip(reaches_m.tolist(), owners, strict=True) if other == owner)
        for owner in owners
    }


class Stature(TypedDict):
    """Measures for which there are WHO standards, with the names of `fits.tables.WHO_FILES`."""

    length_cm: float
    weight_kg: float
    head_circumference_cm: float
    arm_circumference_cm: float | None
    """None for a child without upper arms."""


def stature(tree: BodyTree) -> Stature:
    """Return the measures of a body: length is crown to sole, and the left arm is preferred, as WHO does."""
    arms = [tree.geoms[name] for name in ("left_uarm1", "right_uarm1") if name in tree.geoms]
    head = tree.geoms["head"]
    return Stature(
        length_cm=m_to_cm(length_m(tree)),
        weight_kg=tree.mass_kg,
        head_circumference_cm=m_to_cm(girth(head.type, head.size_m)),
        arm_circumference_cm=m_to_cm(girth(arms[0].type, arms[0].size_m)) if arms else None,
    )


def length_m(tree: BodyTree) -> float:
    """Return the length of a body from crown to sole, in [m]."""
    posed, up = pose(tree, {}), np.array([0.0, 0.0, 1.0])
    return posed.extent(up) + posed.extent(-up)
