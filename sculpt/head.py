"""A child's head: cranium, cheeks, jaw, lips, nose, ears, and lids over the eyes. Lengths are mm."""

from dataclasses import dataclass

import cutting
import meshing
import numpy as np
from faces import FaceShape
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


UPPER, LOWER, CORNER = 40.0, -32.0, 63.0
"""Lids at the middle of an open eye, and the corners of the eye, seen from the middle of the eyeball, [deg]."""
LID = 1.10
"""Radius of the lids over that of the eyeball."""
HEM_MM = 1.6
"""Breadth of the strip along the rim of a lid, which leads to the eyeball."""
MOUTH_HALF = 14.5
"""Distance of a corner of the mouth from the midline."""


def folded(p: Array) -> Array:
    """Return points on the right side: those on the left mirrored."""
    return np.column_stack((p[:, 0], -np.abs(p[:, 1]), p[:, 2]))


def field(head: Head, shape: FaceShape) -> Field:
    """Return the head with closed lids as a field, in its own frame."""
    bare = _without_lips(head, shape)
    lips = _lips(bare, shape)
    ear = _ear(head)

    def whole(p: Array) -> Array:
        q = folded(p)
        d = smooth_min(lips(q, bare(q)), ear(q), 3.5)
        return smooth_min(d, np.linalg.norm(q - head.eye, axis=1) - LID * head.eye_radius, 6.5)

    return whole


def _without_lips(head: Head, shape: FaceShape) -> Field:
    """Return skull, cheeks, jaw and nose."""
    cranium = ellipsoid((0, 0, 0), head.half_axes)
    swellings, jaw, nose = _swellings(head, shape), _jaw(shape), _nose(head, shape)
    socket = ellipsoid(np.add(head.eye, (18.6, -4.0, 1.5)), (11.5, 15.0, 13.5))

    def bare(q: Array) -> Array:
        d = cranium(q)
        for part, k in jaw:
            d = smooth_min(d, part(q), k)
        for middle, size, amount in swellings:
            d = d - amount * np.exp(-(((q - middle) / size) ** 2).sum(axis=1))
        return nose(q, smooth_max(d, -socket(q), 14.0))

    return bare


def _swellings(head: Head, shape: FaceShape) -> list[tuple[Array, Array, float]]:
    """Return middles, half breadths and heights of what stands out softly."""
    ax, ay, az = head.half_axes
    x, y, z = head.eye
    cheek, jowl = shape.cheek, shape.jowl
    below = 0.5 * (z + shape.mouth[1])
    rows = [
        ((0.88 * ax, 0, 0.42 * az), (40, 46, 34), shape.forehead),
        ((-ax, 0, 0.10 * az), (50, 50, 46), shape.occiput),
        ((66, -29, below - 5), (22, 19, 17), cheek),
        ((36, -46, shape.mouth[1] + 1), (30, 24, 22), jowl),
        ((56, -24, shape.mouth[1] - 9), (20, 15, 14), 0.45 * jowl),
        ((80, 0, z), (14, 8.5, 12), shape.bridge),
        ((x + 8, y - 1, z - 12), (8, 11, 5.0), shape.puffy),
        ((x + 7, y - 2, z + 12), (8, 12, 5.5), shape.puffy),
        ((44, -56, 0.10 * az), (22, 16, 22), shape.temple),
    ]
    return [(np.array(middle, float), np.array(size, float), float(amount)) for middle, size, amount in rows]


def _jaw(shape: FaceShape) -> list[tuple[Field, float]]:
    """Return the lower jaw, the chin and what carries the lips, with how softly they are added."""
    mouth_x, mouth_z = shape.mouth
    chin_x, chin_z, radius = shape.chin
    return [
        (ellipsoid((shape.jaw[0], 0, shape.jaw[1]), shape.jaw_size), 16.0),
        (ellipsoid((chin_x - radius, 0, chin_z), (radius, 1.2 * radius, radius)), 11.0),
        (ellipsoid((mouth_x - 14.0, 0, mouth_z + 2.0), (12.0, 17.0, 13.0)), 9.0),
    ]


def _front(field: Field, places: list[tuple[float, float]]) -> list[Array]:
    """Return the points of a surface in front of some y and z."""
    points = np.array([(100.0, y, z) for y, z in places])
    for _ in range(80):
        points[:, 0] -= np.clip(field(points), -2.0, 2.0) * 0.7
    return list(points)


def _lips(bare: Field, shape: FaceShape):
    """Return a function that adds the lips to a field: a soft bow whose corners lie a little higher than its middle."""
    z, half = shape.mouth[1], MOUTH_HALF
    along_upper = [(0, z + 2.5), (-2.4, z + 3.3), (-7.0, z + 2.7), (-half + 1.2, z + 1.9)]
    along_lower = [(0, z - 3.6), (-4.0, z - 3.4), (-9.0, z - 1.8), (-half + 1.6, z + 0.5)]
    upper = _along(bare, along_upper, (2.9, 3.1, 2.6, 1.4), 1.7)
    lower = _along(bare, along_lower, (3.7, 3.5, 2.6, 1.3), 1.9)
    groove, corner = _front(bare, [(0, z + 9.0), (-half - 0.2, z + 1.5)])

    def add(q: Array, d: Array) -> Array:
        d = d + 1.0 * np.exp(-(((q - groove) / (6, 2.3, 5)) ** 2).sum(axis=1))
        d = d + 1.5 * np.exp(-(((q - corner) / (6, 3.2, 3.2)) ** 2).sum(axis=1))
        above, below = smooth_min(d, upper(q), 2.6), smooth_min(d, lower(q), 2.6)
        return np.minimum(above, below)

    return add


def _along(bare: Field, places: list[tuple[float, float]], radii: tuple[float, ...], out: float) -> Field:
    """Return a bent tube under places of a surface, of which as much stands out as *out*, less at its thin end."""
    points, most = _front(bare, places), max(radii)
    middles = [point - (radius - out * radius / most, 0, 0) for point, radius in zip(points, radii, strict=True)]
    pairs = zip(zip(middles, middles[1:], strict=False), zip(radii, radii[1:], strict=False), strict=True)
    tubes = [tube(a, b, both) for (a, b), both in pairs]

    def bent(q: Array) -> Array:
        d = tubes[0](q)
        for part in tubes[1:]:
            d = np.minimum(d, part(q))
        return d

    return bent


def _nose(head: Head, shape: FaceShape):
    """Return a function that adds the nose to a field."""
    x, z, radius = shape.tip
    aside, wing_radius = shape.wing
    tip = ellipsoid((x, 0, z), (radius, 1.15 * radius, 0.95 * radius))
    wing = ball((x - 4.4, -aside, z - 1.6), wing_radius)
    bridge = tube((72.0 + shape.bridge, 0, head.eye[2] - 6.0), (x - 2.0, 0, z + 2.0), (4.6, 4.8))
    nostril = ellipsoid((x - 0.8, -3.0, z - 5.9), (2.0, 1.5, 1.6))

    def add(q: Array, d: Array) -> Array:
        nose = smooth_min(smooth_min(tip(q), wing(q), 3.2), bridge(q), 6.0)
        return smooth_max(smooth_min(d, nose, 6.5), -nostril(q), 2.0)

    return add


def _ear(head: Head) -> Field:
    ax, ay, az = head.half_axes
    tilt, out = np.radians(-14), np.radians(24)
    turn = np.array(((np.cos(tilt), 0, np.sin(tilt)), (0, 1, 0), (-np.sin(tilt), 0, np.cos(tilt)))) @ np.array(
        ((np.cos(out), -np.sin(out), 0), (np.sin(out), np.cos(out), 0), (0, 0, 1))
    )
    middle = np.array((-0.08 * ax, -0.985 * ay - 2.6, -0.17 * az))
    outer = ellipsoid(middle, (11.5, 5.8, 18.0), turn)
    hollow = ellipsoid(middle + turn @ (1.2, -5.6, 1.5), (7.4, 4.4, 12.4), turn)
    tragus = ball(middle + turn @ (8.6, -1.2, -3.0), 3.0)
    lobe = ball(middle + turn @ (2.6, -0.6, -15.0), 4.8)

    def ear(p: Array) -> Array:
        d = smooth_max(outer(p), -hollow(p), 3.6)
        return smooth_min(smooth_min(d, tragus(p), 2.5), lobe(p), 3.5)

    return ear


def opening(head: Head):
    """Return a function of points that is positive between the lids, and about the distance to their rims."""
    outward = np.array((head.eye[0] / head.half_axes[0] ** 2, head.eye[1] / head.half_axes[1] ** 2, 0))
    outward = 0.45 * outward / np.linalg.norm(outward) + 0.55 * np.array((1.0, 0, 0))
    outward /= np.linalg.norm(outward)
    across = np.array((-outward[1], outward[0], 0.0))

    def cut(p: Array) -> Array:
        from_eye = folded(p) - head.eye
        ahead, aside, above = from_eye @ outward, from_eye @ across, from_eye[:, 2]
        azimuth = np.degrees(np.arctan2(aside, ahead)) + 1
        elevation = np.degrees(np.arctan2(above, np.hypot(ahead, aside)))
        t = np.clip(np.abs(azimuth) / CORNER, 0, 1.5)
        upper, lower = UPPER * (1 - t**2.4), LOWER * (1 - t**2.0)
        degrees = np.minimum(upper - elevation, elevation - lower)
        return np.where(ahead > 0, degrees, -90.0) * np.radians(head.eye_radius * LID)

    return cut


def sizes(head: Head, shape: FaceShape, points: Array) -> Array:
    """Return the lengths of edges that are wanted at some points."""
    n, q = points / head.half_axes, folded(points)
    eye = np.linalg.norm(q - head.eye, axis=1)
    nose = np.linalg.norm(points - (shape.tip[0], 0, shape.tip[1]), axis=1)
    mouth = (points - (shape.mouth[0] - 4, 0, shape.mouth[1])) / (18.0, 19.5, 10.5)
    wanted = np.full(len(points), 10.5)
    wanted = np.where((n[:, 0] > 0.42) & (n[:, 2] > 0.1) & (n[:, 2] < 0.75), 8.0, wanted)
    wanted = np.where((n[:, 0] > 0.42) & (n[:, 2] < 0.32) & (n[:, 2] > -0.95), 6.0, wanted)
    wanted = np.where(nose < 13, 3.0, wanted)
    ear = np.abs(points[:, 1]) > 0.95 * head.half_axes[1]
    wanted = np.where(ear & (np.abs(n[:, 0]) < 0.38) & (np.abs(n[:, 2] + 0.17) < 0.38), 3.6, wanted)
    wanted = np.where(eye < head.eye_radius * 1.8, 3.4, wanted)
    far = np.linalg.norm(mouth, axis=1)
    wanted = np.where(far < 1.5, np.minimum(wanted, 3.8), wanted)
    wanted = np.where(far < 1, 2.3, wanted)
    return np.where(eye < head.eye_radius * 1.25, 2.2, wanted)


def mesh(head: Head, shape: FaceShape, rng: np.random.Generator) -> tuple[Array, np.ndarray, np.ndarray]:
    """Return the mesh of a head with open lids, the same on both sides, and for each vertex the one it moves with."""
    whole = field(head, shape)
    reach = head.half_axes + 18
    dense = meshing.largest(*meshing.surface(whole, -reach, np.add(reach, (8, 0, 0)), 0.9))
    verts, faces, _ = meshing.remesh(*dense, lambda points: sizes(head, shape, points), rng)
    verts = meshing.relax(whole, meshing.onto(whole, verts), faces, 2, 0.4)
    verts, faces = cutting.mirrored(verts, faces)
    verts = meshing.relax(whole, verts, faces, 2, 0.4)
    return cutting.hemmed(whole, opening(head), HEM_MM, verts, faces)


def closing(head: Head, verts: Array, sign: float) -> Array:
    """Return how each vertex moves when an eye closes; *sign* is that of the eye's side along y."""
    return lids_moved(head, verts, sign, -0.80, 0.66)


def lids_moved(head: Head, verts: Array, sign: float, upper: float, lower: float) -> Array:
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


def split_at_end(head: Head, verts: Array, faces: np.ndarray) -> tuple[np.ndarray, np.ndarray, Array]:
    """Return a mesh in which each triangle has a vertex of its own where the picture ends.

    Vertices as indices of those before, faces, and texture coordinates.

    The whole border of the picture is one point of the head.
    """
    end = -wrapped(np.array((0.5, 0.5)))
    along = verts / head.half_axes
    nearest = int((along @ end / np.linalg.norm(along, axis=1)).argmax())
    origin = np.arange(len(verts))
    places, faces = texcoords(head, verts), faces.copy()
    for index, corner in np.argwhere(faces == nearest)[1:]:
        faces[index, corner] = len(origin)
        origin, places = np.append(origin, nearest), np.vstack((places, places[nearest]))
    for index, corner in np.argwhere(origin[faces] == nearest):
        middle = (places[np.delete(faces[index], corner)] - 0.5).sum(axis=0)
        places[faces[index, corner]] = 0.5 + 0.5 * middle / np.linalg.norm(middle)
    return origin, faces, places
