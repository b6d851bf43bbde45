"""A child's head: cranium, cheeks, chin, nose, ears, and lids over the eyes. Lengths are mm."""

from dataclasses import dataclass

import clothes
import meshing
import numpy as np
from fields import Array, Field, ball, ellipsoid, smooth_max, smooth_min, tube
from uv_map import unwrapped, wrapped


@dataclass(frozen=True)
class Head:
    """The solids that a head is sculpted on, in a frame at the middle of the head's solid."""

    half_axes: Array
    """Of the head's solid, shape (3,)."""
    eye: Array
    """Middle of the right eye, shape (3,)."""
    eye_radius: float


UPPER, LOWER, CORNER = 38.5, -33.0, 62.0
"""Lids at the middle of an open eye, and the corners of the eye, seen from the middle of the eyeball, [deg]."""
LID = 1.10
"""Radius of the lids over that of the eyeball."""


def field(head: Head) -> Field:
    """Return the head with closed lids as a field, in its own frame."""
    ax, ay, az = head.half_axes
    cranium = ellipsoid((0, 0, 0), head.half_axes)
    face = [
        (ellipsoid((0.60 * ax, -0.40 * ay, -0.36 * az), (26, 24, 23)), 26.0),  # Cheek.
        (ball((0.66 * ax, 0, -0.68 * az), 14), 20.0),  # Chin.
        (ellipsoid((0.82 * ax, 0, -0.50 * az), (9.5, 15, 9)), 20.0),  # Mouth.
    ]
    ear = _ear(head)
    nose = _nose(head)
    socket = ellipsoid(np.add(head.eye, (19.5, -2.5, 0.5)), (13, 15, 12))

    def whole(p: Array) -> Array:
        q = np.column_stack((p[:, 0], -np.abs(p[:, 1]), p[:, 2]))
        d = cranium(q)
        for shape, k in face:
            d = smooth_min(d, shape(q), k)
        d = smooth_max(d, -socket(q), 14.0)
        d = nose(q, d)
        d = smooth_min(d, ear(q), 3.5)
        return smooth_min(d, np.linalg.norm(q - head.eye, axis=1) - LID * head.eye_radius, 6.5)

    return whole


def opening(head: Head):
    """Return a function of points that is positive between the lids, and about the distance to their rims."""
    outward = np.array((head.eye[0] / head.half_axes[0] ** 2, head.eye[1] / head.half_axes[1] ** 2, 0))
    outward = 0.45 * outward / np.linalg.norm(outward) + 0.55 * np.array((1.0, 0, 0))
    outward /= np.linalg.norm(outward)
    across = np.array((-outward[1], outward[0], 0.0))

    def cut(p: Array) -> Array:
        from_eye = np.column_stack((p[:, 0], -np.abs(p[:, 1]), p[:, 2])) - head.eye
        ahead, aside, above = from_eye @ outward, from_eye @ across, from_eye[:, 2]
        azimuth = np.degrees(np.arctan2(aside, ahead)) + 1
        elevation = np.degrees(np.arctan2(above, np.hypot(ahead, aside)))
        t = np.clip(np.abs(azimuth) / CORNER, 0, 1.5)
        upper, lower = UPPER * (1 - t**2.2), LOWER * (1 - t**2.0)
        degrees = np.minimum(upper - elevation, elevation - lower)
        return np.where(ahead > 0, degrees, -90.0) * np.radians(head.eye_radius * LID)

    return cut


def _nose(head: Head):
    ax, _, az = head.half_axes
    tip = ball((0.985 * ax - 0.5, 0, -0.270 * az), 5.6)
    wing = ball((0.955 * ax - 1.0, -4.8, -0.290 * az), 3.9)
    bridge = tube((0.905 * ax, 0, -0.09 * az), (0.970 * ax, 0, -0.23 * az), (4.4, 4.2))

    def add(q: Array, d: Array) -> Array:
        nose = smooth_min(smooth_min(tip(q), wing(q), 3.0), bridge(q), 6.0)
        return smooth_min(d, nose, 7.0)

    return add


def _ear(head: Head) -> Field:
    ax, ay, az = head.half_axes
    tilt, out = np.radians(-14), np.radians(24)
    turn = np.array(((np.cos(tilt), 0, np.sin(tilt)), (0, 1, 0), (-np.sin(tilt), 0, np.cos(tilt)))) @ np.array(
        ((np.cos(out), -np.sin(out), 0), (np.sin(out), np.cos(out), 0), (0, 0, 1))
    )
    middle = np.array((-0.06 * ax, -0.985 * ay - 3.0, -0.16 * az))
    outer = ellipsoid(middle, (9.6, 5.6, 14.5), turn)
    hollow = ellipsoid(middle + turn @ (1.0, -5.6, 1.0), (5.8, 4.2, 10.0), turn)
    tragus = ball(middle + turn @ (7.6, -1.2, -2.6), 2.6)
    lobe = ball(middle + turn @ (2.0, -0.6, -12.2), 4.4)

    def ear(p: Array) -> Array:
        d = smooth_max(outer(p), -hollow(p), 3.6)
        return smooth_min(smooth_min(d, tragus(p), 2.5), lobe(p), 3.5)

    return ear


def mesh(head: Head, rng: np.random.Generator) -> tuple[Array, np.ndarray]:
    """Return the mesh of a head with open lids."""
    whole = field(head)
    reach = head.half_axes + 16
    dense = meshing.largest(*meshing.surface(whole, -reach, np.add(reach, (8, 0, 0)), 0.9))
    verts, faces, _ = meshing.remesh(*dense, lambda points: sizes(head, points), rng)
    verts = meshing.relax(whole, meshing.onto(whole, verts), faces, 2, 0.4)
    cut = opening(head)
    return clothes.sewn(clothes.Cloth("lids", whole, cut, cut, 1.6), verts, faces)[:2]


def sizes(head: Head, points: Array) -> Array:
    """Return the lengths of edges that are wanted at some points."""
    n = points / head.half_axes
    eye = np.linalg.norm(np.column_stack((points[:, 0], -np.abs(points[:, 1]), points[:, 2])) - head.eye, axis=1)
    nose = np.linalg.norm(points - head.half_axes * (1, 0, -0.27), axis=1)
    found = np.full(len(points), 10.0)
    found = np.where((n[:, 0] > 0.45) & (n[:, 2] < 0.35) & (n[:, 2] > -0.8), 6.0, found)
    found = np.where(nose < 13, 3.0, found)
    ear = np.abs(points[:, 1]) > 0.95 * head.half_axes[1]
    found = np.where(ear & (np.abs(n[:, 0]) < 0.35) & (np.abs(n[:, 2] + 0.15) < 0.35), 3.2, found)
    found = np.where(eye < head.eye_radius * 1.7, 3.2, found)
    return np.where(eye < head.eye_radius * 1.25, 2.1, found)


def newborn(head: Head, verts: Array) -> Array:
    """Return the vertices of a newborn's head: round eyes, flat nose, small chin."""
    ax, ay, az = head.half_axes
    found = verts.copy()

    def near(centre: tuple[float, float, float], radius: float) -> Array:
        far = np.linalg.norm(np.column_stack((verts[:, 0], -np.abs(verts[:, 1]), verts[:, 2])) - centre, axis=1)
        return np.exp(-((far / radius) ** 2))[:, None]

    side = np.sign(verts[:, 1])[:, None] * (0, 1, 0)
    found += near((0.66 * ax, -0.55 * ay, -0.52 * az), 27) * ((1.6, 0, -1.5) + 5.0 * side)
    found += near((0.72 * ax, 0, -0.78 * az), 22) * (-5.0, 0, 4.0)
    tip = near((1.0 * ax, 0, -0.26 * az), 11)
    found += tip * ((0.93 * ax, 0, -0.255 * az) - verts) * (0.35, -0.12, 0.18)
    for sign in (-1.0, 1.0):
        found += _lids_moved(head, verts, sign, 0.86, 1.10)
    return _flattened(head, found)


FLAT_MM = 2.4
"""How far a newborn's face is beyond the head's solid at most: it cannot lift it off the floor."""


def _flattened(head: Head, verts: Array) -> Array:
    """Return vertices of which those in front are at most a little beyond the solid."""
    size = np.linalg.norm(verts / head.half_axes, axis=1)
    slope = np.linalg.norm(verts / head.half_axes**2, axis=1)
    beyond = size * (size - 1) / slope
    front = np.clip(verts[:, 0] / (0.3 * head.half_axes[0]) - 0.2, 0, 1)
    less = np.where(beyond > 0, beyond - FLAT_MM * np.tanh(beyond / FLAT_MM), 0) * front
    normal = (verts / head.half_axes**2) / slope[:, None]
    return verts - less[:, None] * normal


def closing(head: Head, verts: Array, sign: float) -> Array:
    """Return how each vertex moves when an eye closes; *sign* is that of the eye's side along y."""
    return _lids_moved(head, verts, sign, -0.80, 0.66)


def _lids_moved(head: Head, verts: Array, sign: float, upper: float, lower: float) -> Array:
    """Return how vertices move with lids that are turned about the eyeball to shares of their usual elevations."""
    centre = head.eye * (1, -sign, 1)
    from_eye = verts - centre
    far = np.linalg.norm(from_eye, axis=1)
    elevation = np.degrees(np.arcsin(np.clip(from_eye[:, 2] / np.maximum(far, 1e-9), -1, 1)))
    reach = np.clip((1.9 - far / head.eye_radius) / 0.7, 0, 1) * (from_eye[:, 0] > -2)
    share = np.where(elevation > 0, upper, lower)
    rim = np.where(elevation > 0, UPPER, -LOWER)
    fade = np.clip(1.6 - np.abs(elevation) / rim * 0.75, 0, 1)
    turn = np.radians(elevation * (share - 1) * reach * fade)
    level = np.hypot(from_eye[:, 0], from_eye[:, 1])
    angle = np.arctan2(from_eye[:, 2], level)
    moved = np.column_stack(
        (from_eye[:, :2] * (far * np.cos(angle + turn) / np.maximum(level, 1e-9))[:, None], far * np.sin(angle + turn))
    )
    return moved - from_eye


def texcoords(head: Head, verts: Array) -> Array:
    """Return places in the face's texture, (n, 2): see `uv_map`."""
    return unwrapped(verts / head.half_axes)


def split_at_end(head: Head, verts: Array, faces: np.ndarray) -> tuple[Array, np.ndarray, Array]:
    """Return a mesh in which each triangle has a vertex of its own where the picture ends, and texture coordinates.

    The whole border of the picture is one point of the head.
    """
    end = -wrapped(np.array((0.5, 0.5)))
    along = verts / head.half_axes
    nearest = int((along @ end / np.linalg.norm(along, axis=1)).argmax())
    verts = verts.copy()
    verts[nearest] = end * head.half_axes * np.linalg.norm(along[nearest])
    places, faces = texcoords(head, verts), faces.copy()
    for index, corner in np.argwhere(faces == nearest)[1:]:
        faces[index, corner] = len(verts)
        verts = np.vstack((verts, verts[nearest]))
        places = np.vstack((places, places[nearest]))
    for index, corner in np.argwhere(np.isin(faces, [nearest, *range(len(along), len(verts))])):
        others = places[np.delete(faces[index], corner)] - 0.5
        middle = others.sum(axis=0)
        places[faces[index, corner]] = 0.5 + 0.5 * middle / np.linalg.norm(middle)
    return verts, faces, places
