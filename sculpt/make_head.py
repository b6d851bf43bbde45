"""The arrays of the head that ships with mimoc, at all ages: `python sculpt/make_skin.py --only head` writes them."""

from dataclasses import dataclass

import head as heads
import head_mesh
import meshing
import numpy as np
from expressing import EXPRESSED, moved
from faces import MESHED, SHAPES, FaceShape
from fields import Array
from scipy.interpolate import PchipInterpolator, RBFInterpolator

from mimoc.base.geometry.solvers import smoothstep
from mimoc.body.grow import grow_body
from mimoc.compiler.looks.sculpture import MOVE_M
from mimoc.schema.infant import InfantSpec

WHORL = np.array((-0.52, 0.0, 0.85))  # Direction of the whorl, from the middle of the head.
AROUND_DEG = (0, 25, 42, 56, 68, 76, 86, 100, 114, 128, 150, 180)
LINE_DEG = (44, 43, 39, 29, 11, -2, 3, 5, -3, -19, -35, -41)
"""Elevation of the hairline by how far to the side, from the front to the nape: above the ears and behind them (D)."""
FRINGE_DEG = (-14, -13, -7, -2, -1, -1, 0, 0, 0, 0, 0, 0)
"""How much lower it is where a fringe falls onto the forehead."""
WAVES = 0.016  # How much hair turns aside here and there, as a share of half a turn.
RIM_DEG = 9.0  # How far beyond the lowest hairline the layer goes on.
WORN = np.array((-0.98, 0.0, 0.05))  # Direction of the middle of what rubs on the ground.


@dataclass(frozen=True)
class Scalp:
    """The part of the head's mesh that has hair, of n vertices."""

    verts: np.ndarray  # Of the head, shape (n,).
    faces: np.ndarray  # Of these, shape (m, 3).
    inside: Array  # How far within the hairline they are, and how much farther with a full fringe, [deg], shape (n, 2).
    around: Array  # Which way from the whorl, 0 to 1, the same on both sides, shape (n,).
    worn: Array  # How much of the hair rubs off on the ground, 0 to 1, shape (n,).


def scalp(half_axes: Array, verts: Array, faces: np.ndarray) -> Scalp:
    """Return where a head has hair.

    Args:
        half_axes: Of the head's solid, shape (3,).
        verts: Of the head, in the frame of its solid.
        faces: Of the head.
    """
    ways = verts / half_axes
    ways = ways / np.linalg.norm(ways, axis=1, keepdims=True)
    inside = _inside(ways)
    is_ear = (np.abs(verts[:, 1]) > 1.045 * half_axes[1]) & (np.abs(ways[:, 2] + 0.1) < 0.32)
    near = (inside.sum(axis=1) > -RIM_DEG) & ~is_ear
    faces = _welded(verts, faces)
    kept = faces[near[faces].all(axis=1)]
    used = np.unique(kept)
    number = np.zeros(len(verts), np.intp)
    number[used] = np.arange(len(used))
    worn = np.exp(-((np.degrees(np.arccos(np.clip(ways @ (WORN / np.linalg.norm(WORN)), -1, 1))) / 27) ** 2))
    return Scalp(used, number[kept], inside[used], _around(ways)[used], worn[used])


def _welded(verts: Array, faces: np.ndarray) -> np.ndarray:
    """Return faces of a mesh in which vertices in one place are one."""
    _, first, same = np.unique(verts, axis=0, return_index=True, return_inverse=True)
    welded = first[same.reshape(-1)][faces]
    return welded[(welded != np.roll(welded, 1, axis=1)).all(axis=1)]


def _inside(ways: Array) -> Array:
    azimuth = np.degrees(np.abs(np.arctan2(ways[:, 1], ways[:, 0])))
    elevation = np.degrees(np.arcsin(np.clip(ways[:, 2], -1, 1)))
    line, fringe = (PchipInterpolator(AROUND_DEG, table)(azimuth) for table in (LINE_DEG, FRINGE_DEG))
    return np.column_stack((elevation - line, -fringe))


def _around(ways: Array) -> Array:
    whorl = WHORL / np.linalg.norm(WHORL)
    front = np.array((1.0, 0, 0)) - whorl[0] * whorl
    front /= np.linalg.norm(front)
    aside = np.cross(whorl, front)
    around = np.abs(np.arctan2(ways @ aside, ways @ front)) / np.pi
    far = np.arccos(np.clip(ways @ whorl, -1, 1))
    waves = np.sin(4.2 * far + 11 * around) + 0.6 * np.sin(7.5 * far - 17 * around + 1)
    return around + WAVES * np.sin(np.pi * around) * waves


AGE_MONTHS = 9.0  # Age of the child whose head's solid all ages are sculpted on.
SEED = 16


def sculpt_head() -> dict[str, np.ndarray]:
    """Return the arrays of the head."""
    sculpted = reference_head()
    mesh = meshed(sculpted)
    at_ages = [mesh.whole(aged(sculpted, mesh, SHAPES[age])) for age in SHAPES]
    print("head", len(at_ages[0]), "vertices", len(mesh.faces), "faces")
    return {
        "ages_months": np.array(list(SHAPES), float),
        "at_ages_m": (np.array(at_ages) / 1000).astype(np.float32),
        "lids": np.array([shape.lids for shape in SHAPES.values()]),
        "faces": mesh.faces.astype(np.uint16),
        "texcoords": mesh.places.astype(np.float32),
        "half_axes_m": sculpted.half_axes / 1000,
        "eye_m": sculpted.eye / 1000,
        "eye_radius_m": np.array(sculpted.eye_radius / 1000),
        **_hair_of(sculpted, mesh, at_ages[list(SHAPES).index(MESHED)]),
        **{f"moves/{name}": _small(mesh.moved(moved(mesh, face))) for name, face in EXPRESSED.items()},
        **{f"lids/{name}": np.array(face.lids) for name, face in EXPRESSED.items()},
    }


def _hair_of(sculpted: heads.Head, mesh: "HeadMesh", verts: Array) -> dict[str, np.ndarray]:
    hair = scalp(sculpted.half_axes, verts, mesh.faces)
    print("hair", len(hair.verts), "vertices")
    return {
        "hair/verts": hair.verts.astype(np.uint16),
        "hair/faces": hair.faces.astype(np.uint16),
        "hair/inside_deg": hair.inside.astype(np.float32),
        "hair/around": hair.around.astype(np.float32),
        "hair/worn": hair.worn.astype(np.float32),
    }


def _small(moves_mm: Array) -> np.ndarray:
    """Return moves in the unit of the file."""
    return np.rint(moves_mm / 1000 / MOVE_M).astype(np.int16)


@dataclass(frozen=True)
class HeadMesh:
    """The mesh that all ages share, on the age that it was made at."""

    verts: Array  # Of the surface with the strips along lids and lips, shape (n, 3).
    twins: np.ndarray  # The vertex that each of them moves with: itself, or of a strip's that at the edge.
    side: np.ndarray  # Which lip each moves with: 1 above the line on which the lips meet, -1 below, shape (n,).
    origin: np.ndarray  # For each vertex of the surface in the picture's order, the one of these that it is.
    loop: np.ndarray  # Those at which the pocket of the mouth begins, in order.
    faces: np.ndarray  # Of all vertices: the surface's in the picture's order, and the pocket's.
    places: Array  # Of all vertices in the picture of a face.

    def whole(self, verts: Array) -> Array:
        """Return all vertices, with the pocket behind the lips, of a surface."""
        return np.vstack((verts[self.origin], head_mesh.pocket(verts, self.loop)))

    def moved(self, moves: Array) -> Array:
        """Return how all vertices move when those of the surface do."""
        return self.whole(self.verts + moves) - self.whole(self.verts)


LIP_MM = 4.0  # How far lips lead inwards.
WITHIN_EYEBALL = 0.95  # Where lids end, in radii of the eyeball.


def meshed(head: heads.Head) -> HeadMesh:
    """Return the mesh of the head."""
    shape = SHAPES[MESHED]
    verts, faces, twins = head_mesh.mesh(head, shape, np.random.default_rng(SEED))
    line, corner = heads.mouth_line(head, shape), heads.mouth_corner(head, shape)
    strip = np.flatnonzero(twins != np.arange(len(verts)))
    rims = strip[len(strip) // 2 :]
    is_lip = np.linalg.norm((verts[twins[rims]] - corner * (1, 0, 1)) / (14, 16, 6), axis=1) < 1
    inner, lids = rims[is_lip], rims[~is_lip]
    verts[inner] = verts[twins[inner]] - (LIP_MM, 0, 0)
    verts[lids] = _at_eyeball(head, verts[twins[lids]])
    origin, split, places = head_mesh.split_at_end(head, verts, faces)
    loop = head_mesh.loop_around(inner, faces)
    behind = head_mesh.pocket_faces(len(loop), len(origin))
    side = head_mesh.lip_sides(line, verts, faces, twins)
    places = np.vstack((places, head_mesh.pocket_places(verts[loop], side[loop])))
    return HeadMesh(verts, twins, side, origin, loop, np.vstack((split, behind)), places)


def _at_eyeball(head: heads.Head, rims: Array) -> Array:
    """Return where strips from the rims of lids, shape (n, 3), end: a little within the eyeball, without a gap."""
    eyes = head.eye * np.where(rims[:, 1:2] < 0, (1, 1, 1), (1, -1, 1))
    from_eye = rims - eyes
    return eyes + from_eye * (WITHIN_EYEBALL * head.eye_radius / np.linalg.norm(from_eye, axis=1, keepdims=True))


def reference_head() -> heads.Head:
    """Return the solids of the head of an average child."""
    spec = InfantSpec.model_validate({"mimoc": 1, "name": "child", "age_months": AGE_MONTHS})
    tree = grow_body(spec).tree
    solid, eye = tree.geoms["head"], next(body for body in tree.bodies if body.name == "right_eye")
    middle = np.subtract(eye.pos_m, solid.pos_m)
    return heads.Head(np.array(solid.size_m) * 1000, middle * 1000, tree.geoms["right_eye1"].size_m[0] * 1000)


def aged(head: heads.Head, mesh: HeadMesh, shape: FaceShape) -> Array:
    """Return the vertices of the mesh on the head of another age: features go with features.

    Args:
        head: The solids.
        mesh: Its surface.
        shape: Of the other age.
    """
    verts, twins = mesh.verts, mesh.twins
    before, after = landmarks(head, SHAPES[MESHED]), landmarks(head, shape)
    moves = RBFInterpolator(before, after - before, kernel="thin_plate_spline")(verts)
    on_field = meshing.onto(heads.field(head, shape), verts + moves, rounds=8, most=2.0)
    from_eye = np.linalg.norm(heads.folded(verts) - head.eye, axis=1) / head.eye_radius
    share = smoothstep((from_eye - 1.14) / 0.3)[:, None] * (1 - head_mesh.ear_share(verts)[:, None])
    grown = verts + share * (on_field - verts)
    inward = np.flatnonzero(twins != np.arange(len(verts)))
    grown[inward] = grown[twins[inward]] + (verts[inward] - verts[twins[inward]])
    return grown


def landmarks(head: heads.Head, shape: FaceShape) -> Array:
    """Return places on a face that correspond between ages, and others that stay."""
    (tip_x, tip_z, _), (mouth_x, mouth_z) = shape.tip, shape.mouth
    chin_x, chin_z, radius = shape.chin
    jaw_x, jaw_z = shape.jaw
    across = [
        (tip_x + 5, 0, tip_z),
        (tip_x - 2, 0, tip_z - 7),
        (tip_x - 4, shape.wing[0] + 3, tip_z - 2),
        (mouth_x - 1, 0, mouth_z + 3),
        (mouth_x, 0, mouth_z),
        (mouth_x - 1, 0, mouth_z - 4),
        (mouth_x - 9, heads.MOUTH_HALF, mouth_z + 1),
        (chin_x, 0, chin_z),
        (chin_x - radius, 0, chin_z - radius),
        (jaw_x, 0, jaw_z - shape.jaw_size[2]),
        (jaw_x, shape.jaw_size[1], jaw_z),
    ]
    ax, ay, az = head.half_axes
    stay = [(ax, 0, 0.3 * az), (0.7 * ax, 0, 0.7 * az), (0, 0, az), (-ax, 0, 0), (-0.5 * ax, 0, -0.8 * az), (0, ay, 0)]
    stay += [(-0.1 * ax, ay, -0.35 * az), (0.5 * ax, 0.8 * ay, 0.2 * az), (0.45 * ax, 0.87 * ay, -0.15 * az)]
    ring = [(0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    stay += [tuple(head.eye * (1, -1, 1) + np.array((6.0, 0, 0)) + 12.0 * np.array(way)) for way in ring]
    points = [*across, *stay]
    return np.array([*points, *((x, -y, z) for x, y, z in points if y)], float)
