"""A child's head: cranium, cheeks, jaw, lips, nose, ears, and lids over the eyes. Lengths are mm."""

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from faces import FaceShape
from fields import Array, Field, ball, ellipsoid, smooth_max, smooth_min, tube

from mimoc.compiler.looks.head import CORNER_DEG, LOWER_LID_DEG, UPPER_LID_DEG, outward_of, seen_from_eye


@dataclass(frozen=True)
class Head:
    """The solids that a head is sculpted on, in a frame at the middle of the head's solid."""

    half_axes: Array  # Of the head's solid, shape (3,).
    eye: Array  # Middle of the right eye, shape (3,).
    eye_radius: float


LID = 1.10  # Radius of the lids over that of the eyeball.
MOUTH_HALF = 15.5  # Distance of a corner of the mouth from the midline.
CORNER_IN = 1.0  # How far inside of it the lips part.


def folded(p: Array) -> Array:
    """Return points on the right side: those on the left mirrored."""
    return np.column_stack((p[:, 0], -np.abs(p[:, 1]), p[:, 2]))


def field(head: Head, shape: FaceShape) -> Field:
    """Return the head with closed lids as a field, in its own frame."""
    bare = _without_lips(head, shape)
    lips = _lips(head, shape, bare)
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
    ax, _, az = head.half_axes
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
        ((-8, -58, 0.42 * az), (52, 30, 44), shape.side),
    ]
    return [(np.array(middle, float), np.array(size, float), float(amount)) for middle, size, amount in rows]


def _jaw(shape: FaceShape) -> list[tuple[Field, float]]:
    """Return the lower jaw, the chin and what carries the lips, with how softly they are added."""
    mouth_x, mouth_z = shape.mouth
    chin_x, chin_z, radius = shape.chin
    return [
        (ellipsoid((shape.jaw[0], 0, shape.jaw[1]), shape.jaw_size), 16.0),
        (ellipsoid((chin_x - radius, 0, chin_z), (radius, 1.2 * radius, radius)), 11.0),
        (ellipsoid((mouth_x - 14.2, 0, mouth_z + 2.0), (12.0, 18.0, 13.0)), 9.0),
    ]


def _front(field: Field, places: list[tuple[float, float]]) -> list[Array]:
    """Return the points of a surface in front of some y and z."""
    points = np.array([(100.0, y, z) for y, z in places])
    for _ in range(80):
        points[:, 0] -= np.clip(field(points), -2.0, 2.0) * 0.7
    return list(points)


def _lips(head: Head, shape: FaceShape, bare: Field):
    """Return a function that adds the lips to a field: a soft bow whose corners lie a little higher than its middle."""
    upper, lower = lip_tubes(head, shape)
    groove, corner = _front(bare, [(0, shape.mouth[1] + 9.0), (-MOUTH_HALF - 0.2, shape.mouth[1] + 2.4)])

    def add(q: Array, d: Array) -> Array:
        d = d + 1.0 * np.exp(-(((q - groove) / (6, 2.3, 5)) ** 2).sum(axis=1))
        d = d + 1.5 * np.exp(-(((q - corner) / (6, 3.2, 3.2)) ** 2).sum(axis=1))
        return np.minimum(smooth_min(d, upper(q), 2.6), smooth_min(d, lower(q), 2.6))

    return add


def lip_tubes(head: Head, shape: FaceShape) -> tuple[Field, Field]:
    """Return the upper and the lower lip of the right side, of which a part stands out of the face."""
    bare, z, half = _without_lips(head, shape), shape.mouth[1], MOUTH_HALF
    along_upper = [(0, z + 2.5), (-2.4, z + 3.3), (-7.0, z + 2.7), (-half + 1.2, z + 2.5)]
    along_lower = [(0, z - 3.6), (-4.0, z - 3.4), (-9.0, z - 1.5), (-half + 1.6, z + 1.1)]
    return _along(bare, along_upper, (2.9, 3.1, 2.6, 1.4), 1.35), _along(bare, along_lower, (3.7, 3.5, 2.6, 1.3), 1.5)


def mouth_line(head: Head, shape: FaceShape) -> Field:
    """Return a function of points that is about their height above the line on which the lips meet."""
    upper, lower = lip_tubes(head, shape)
    return lambda p: 0.5 * (lower(folded(p)) - upper(folded(p)))


def mouth_corner(head: Head, shape: FaceShape) -> Array:
    """Return the right corner of the mouth."""
    line, whole = mouth_line(head, shape), field(head, shape)
    point = np.array([(80.0, -MOUTH_HALF + CORNER_IN, shape.mouth[1] + 1.8)])
    for _ in range(60):
        point[:, 0] -= 0.6 * np.clip(whole(point), -2, 2)
        point[:, 2] -= 0.6 * np.clip(line(point), -1, 1)
    return point[0]


def _along(bare: Field, places: list[tuple[float, float]], radii: tuple[float, ...], out: float) -> Field:
    """Return a bent tube under places of a surface, of which as much stands out as *out*, less at its thin end."""
    points, most = _front(bare, places), max(radii)
    middles = [point - (radius - out * radius / most, 0, 0) for point, radius in zip(points, radii, strict=True)]
    pieces = zip(pairwise(middles), pairwise(radii), strict=True)
    tubes = [tube(a, b, both) for (a, b), both in pieces]

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
    outward = outward_of(head.eye, head.half_axes)

    def cut(p: Array) -> Array:
        from_eye = folded(p) - head.eye
        azimuth, elevation = seen_from_eye(from_eye, outward)
        t = np.clip(np.abs(azimuth) / CORNER_DEG, 0, 1.5)
        upper, lower = UPPER_LID_DEG * (1 - t**2.4), LOWER_LID_DEG * (1 - t**2.0)
        degrees = np.minimum(upper - elevation, elevation - lower)
        return np.where(from_eye @ outward > 0, degrees, -90.0) * np.radians(head.eye_radius * LID)

    return cut
