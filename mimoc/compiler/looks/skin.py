"""The skin of a child, carried from the sculpture by the child's solids."""

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np

from mimoc.base.errors import GeometryError
from mimoc.base.geometry.meshes import Steps, normals_of, on_grid, smoothed, steps_between
from mimoc.base.geometry.primitives import extents
from mimoc.base.geometry.rotations import FloatArray, matrix_from_euler
from mimoc.body.kinematics import Posed, frames, pose
from mimoc.body.tree import BodyTree, Geom, head_radius
from mimoc.compiler.looks.head import deform_head, hair_over
from mimoc.compiler.looks.sculpture import (
    BODY,
    HAIR,
    HEAD,
    OUTFITS,
    IntArray,
    Piece,
    SculptedMesh,
    Sculpture,
    dressed,
    template_mesh,
)
from mimoc.compiler.mjcf.scene import Skin, SkinLayer

MIN_SLOPE = 0.3  # Smallest square of a blended slope that is divided by: between two fingers, the slopes cancel.


def surface_distance(
    posed: Posed, solids: Sequence[str], near: IntArray, blend_m: FloatArray, points: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the heights of points above the solids near them, blended, (n,), and their slopes, (n, 3).

    Both are 0 at a point near which the body has no solid.

    Args:
        posed: The body.
        solids: Names of solids; those that the body does not have are left out.
        near: Indices of the solids near each point, shape (n, k).
        blend_m: Width of the blend at each point, shape (n,).
        points: Shape (n, 3), in the frame of the hip.

    """
    number = {geom.name: index for index, geom in enumerate(posed.geoms)}
    if number.keys().isdisjoint(solids):
        raise GeometryError(f"skin: the body has no solid that is called as one of the skin's, such as '{solids[0]}'")
    owner = np.array([number.get(name, -1) for name in solids])[near.ravel()]
    turns = np.array(posed.rotations)[owner]
    sizes = np.array([_three(geom) for geom in posed.geoms])[owner]
    from_centres = np.repeat(points, near.shape[1], axis=0) - np.array(posed.centres)[owner]
    local = np.einsum("ni,nij->nj", from_centres, turns)
    far = np.full(len(owner), np.inf)
    away = np.zeros((len(owner), 3))
    for kind in {geom.type for geom in posed.geoms}:
        alike = np.array([*(geom.type == kind for geom in posed.geoms), False])  # The last one is of those left out.
        of_kind = np.flatnonzero(alike[owner])
        far[of_kind], away[of_kind] = height_above(kind, sizes[of_kind], local[of_kind])
    away = np.einsum("nij,nj->ni", turns, away)
    return _blended(far.reshape(near.shape), away.reshape(*near.shape, 3), blend_m)


def _three(geom: Geom) -> tuple[float, float, float]:
    first, second, third, *_ = (*geom.size_m, 0.0, 0.0)
    return first, second, third


def height_above(kind: str, sizes: FloatArray, points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the heights of points above solids of one type, (n,), and the directions away from them, (n, 3).

    Each point is in the frame of its solid, whose *sizes*, shape (n, 3), are as MuJoCo has them.

    """
    if kind in ("sphere", "capsule"):
        axis = points.copy()
        if kind == "capsule":
            axis[:, 2] -= np.clip(points[:, 2], -sizes[:, 1], sizes[:, 1])
        far = np.linalg.norm(axis, axis=1)
        return far - sizes[:, 0], axis / np.maximum(far, 1e-9)[:, None]
    if kind == "ellipsoid":
        inner = np.linalg.norm(points / sizes, axis=1)
        slope = points / sizes**2
        steep = np.maximum(np.linalg.norm(slope, axis=1), 1e-9)
        return inner * (inner - 1) / steep, slope / steep[:, None]
    if kind == "cylinder":
        around = np.maximum(np.hypot(points[:, 0], points[:, 1]), 1e-9)
        excess = np.column_stack((around - sizes[:, 0], np.abs(points[:, 2]) - sizes[:, 1]))
        height, parts = _beyond(excess)
        across = parts[:, :1] * points[:, :2] / around[:, None]
        return height, np.column_stack((across, parts[:, 1] * np.sign(points[:, 2])))
    height, parts = _beyond(np.abs(points) - sizes)
    return height, parts * np.sign(points)


def _beyond(excess: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the distance to a box from how far points are beyond each of its sides, and its slope in these."""
    outside = np.maximum(excess, 0)
    far = np.linalg.norm(outside, axis=1)
    nearest = (np.arange(excess.shape[1]) == excess.argmax(axis=1)[:, None]).astype(float)
    slope = np.where((far > 1e-9)[:, None], outside / np.maximum(far, 1e-9)[:, None], nearest)
    return far + np.minimum(excess.max(axis=1), 0), slope


def _blended(far: FloatArray, away: FloatArray, blend_m: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the smooth minimum of heights, shape (n, k), and its slope."""
    least = far.min(axis=1)
    known = np.isfinite(least)
    least = np.where(known, least, 0)
    shares = np.exp(-(far - least[:, None]) / blend_m[:, None])
    total = np.where(known, shares.sum(axis=1), 1)
    slope = np.einsum("nk,nki->ni", shares / total[:, None], away)
    return least - blend_m * np.log(total), np.where(known[:, None], slope, 0)


ROUNDS = 2  # Steps of Newton's method towards the sculpted heights above the solids.
FARTHEST = 0.06  # Largest of these steps, in head radii.
SMOOTHINGS = 8
"""How often these moves are smoothed over the mesh, lest the gaps between the solids of a thin child show (D)."""
GONE = 0.98  # Share of missing bodies in a vertex above which it is left out.


@lru_cache(maxsize=4)
def skin_of(tree: BodyTree) -> Skin:
    """Return the skin of a body: the same vertices, in the same order, at all ages and for all children.

    Only those of removed limbs are left out. That of the last few bodies is kept: many scenes have the same infant.
    """
    names = (BODY, *OUTFITS[tree.clothes], HEAD, HAIR)
    return Skin(names, lambda: layers_of(tree, template_mesh(tree.hands)), lambda: moves_of(tree))


def layers_of(tree: BodyTree, sculpted: Sculpture) -> tuple[SkinLayer, ...]:
    """Return the layers of a body's skin, carried from a sculpture."""
    carried = _Carrying(sculpted, tree)
    return (*carried.dressed(), *carried.head())


def moves_of(tree: BodyTree) -> dict[str, Steps]:
    """Return how far each expression moves the vertices of the head's layer, shape (n, 3)."""
    sculpted = template_mesh(tree.hands)
    _, turn = frames(tree, sculpted.angles_rad)[HEAD]
    neutral_m = deform_head(sculpted.head, tree) @ turn.T
    return {
        name: steps_between(neutral_m, deform_head(sculpted.head, tree, name) @ turn.T)
        for name in sculpted.head.moves_m
    }


class _Carrying:
    """A sculpture and the body that it is carried to, in the same pose."""

    def __init__(self, sculpted: Sculpture, tree: BodyTree):
        self.sculpted, self.tree = sculpted, tree
        self.placed, self.posed = frames(tree, sculpted.angles_rad), pose(tree, sculpted.angles_rad)
        self.boxes = boxes(tree)
        self.scale = head_radius(tree.geoms["head"]) / sculpted.head_radius_m
        self.homes = [self._home(part) for part in sculpted.parts]
        self.is_missing = np.array([tree.home(part) not in self.placed for part in sculpted.parts])
        stretches = [self._stretched(index, part) for index, part in enumerate(sculpted.parts)]
        self.turns, self.shifts, self.sizes = map(np.array, zip(*stretches, strict=True))

    def _home(self, part: str) -> str:
        """Return the body that moves what a body of the sculpture does: itself, or the nearest that is not missing."""
        home = self.tree.home(part)
        return home if home in self.placed else self._home(self.sculpted.parents[part])

    def dressed(self) -> Iterator[SkinLayer]:
        """Yield the layers of the body in its clothes."""
        mesh = self.sculpted.mesh
        verts_m, sizes = self._moved(mesh)
        lost = (mesh.weights * self.is_missing[mesh.bones]).sum(axis=1)
        verts_m = self._on_solids(mesh, verts_m, sizes, lost)
        sizes = sizes * (1 - lost)
        normals = normals_of(verts_m, mesh.faces)
        # How much fuller than its solids each vertex of the reference child would be at the child's age.
        ages = self.sculpted.ages_months
        share = np.zeros(len(self.sculpted.ages_months))
        for index, unit in enumerate(np.eye(len(ages))):
            share[index] = np.interp(self.tree.age_months, ages, unit)
        verts_m = verts_m + ((share @ self.sculpted.fullness_m) * sizes)[:, None] * normals
        normals = normals_of(verts_m, mesh.faces)
        for piece in dressed(self.sculpted, self.tree.clothes):
            lifts_m = piece.lifts_m * sizes[piece.sources]
            yield self._layer(piece, verts_m[piece.sources] + lifts_m[:, None] * normals[piece.sources], lost)

    def _layer(self, piece: Piece, verts_m: FloatArray, lost: FloatArray) -> SkinLayer:
        mesh = self.sculpted.mesh
        bones_of, weights_of = mesh.bones[piece.sources], mesh.weights[piece.sources]
        moved_by = {self.homes[index] for index in np.unique(bones_of[weights_of > 0])}
        bones = sorted(moved_by, key=[*self.placed].index)
        column = np.array([bones.index(home) if home in bones else 0 for home in self.homes])
        weights = np.zeros((len(verts_m), len(bones)))
        np.add.at(weights, (np.arange(len(verts_m))[:, None], column[bones_of]), weights_of)
        kept = piece.faces[~(lost[piece.sources][piece.faces] > GONE).all(axis=1)]
        used = np.unique(kept)
        number = np.zeros(len(verts_m), np.intp)
        number[used] = np.arange(len(used))
        moving = np.flatnonzero(weights[used].sum(axis=0))
        names = tuple(bones[index] for index in moving)
        return SkinLayer(
            piece.name,
            verts_m[used],
            number[kept],
            piece.texcoords[used],
            names,
            np.array([self.placed[bone][0] for bone in names]).reshape(-1, 3),
            np.array([self.placed[bone][1] for bone in names]).reshape(-1, 3, 3),
            weights[used][:, moving],
        )

    def head(self) -> tuple[SkinLayer, SkinLayer]:
        """Return the head and its hair."""
        sculpted = self.sculpted.head
        verts_m = deform_head(sculpted, self.tree)
        hair_m, places = hair_over(sculpted.hair, verts_m, self.tree.age_months, self.scale)
        return (
            self._on_head(HEAD, verts_m, sculpted.faces, sculpted.texcoords),
            self._on_head(HAIR, hair_m, sculpted.hair.faces, places),
        )

    def _on_head(self, name: str, verts_m: FloatArray, faces: IntArray, places: FloatArray) -> SkinLayer:
        origin, turn = self.placed[HEAD]
        bind = (HEAD,), origin[None], turn[None], np.ones((len(verts_m), 1))
        return SkinLayer(name, on_grid(origin + verts_m @ turn.T), faces, places, *bind)

    def _moved(self, mesh: SculptedMesh) -> tuple[FloatArray, FloatArray]:
        """Return each vertex where its bodies take it as they are stretched, and how large these are."""
        turn = np.einsum("nk,nkij->nij", mesh.weights, self.turns[mesh.bones])
        shift = np.einsum("nk,nki->ni", mesh.weights, self.shifts[mesh.bones])
        sizes = (mesh.weights * self.sizes[mesh.bones]).sum(axis=1)
        return np.einsum("nij,nj->ni", turn, mesh.verts_m) + shift, sizes

    def _stretched(self, index: int, part: str) -> tuple[FloatArray, FloatArray, float]:
        """Return what takes places in a body of the sculpture to the child's, in the frame of the hip, and its size.

        A place x goes to matrix @ x + shift.
        """
        sculpted, home = self.sculpted, self.tree.home(part)
        if home not in self.placed:  # All of it goes to the joint above.
            parent = sculpted.parents[part]
            matrix, shift, size = self._stretched(sculpted.parts.index(parent), parent)
            return np.zeros((3, 3)), matrix @ sculpted.origins_m[index] + shift, size
        low, high = self.boxes[home]
        stretch = (high - low) / (sculpted.high_m[index] - sculpted.low_m[index])
        if home != part:
            stretch = np.full(3, self.scale)
            low = sculpted.low_m[index] * self.scale
        origin, turn = self.placed[home]
        matrix = turn * stretch @ sculpted.turns[index].T
        shift = origin + turn @ (low - stretch * sculpted.low_m[index]) - matrix @ sculpted.origins_m[index]
        return matrix, shift, float(np.cbrt(stretch.prod()))

    def _on_solids(self, mesh: SculptedMesh, verts_m: FloatArray, sizes: FloatArray, lost: FloatArray) -> FloatArray:
        """Return vertices at their sculpted heights above the child's solids."""
        wanted = mesh.offsets_m * sizes
        most = FARTHEST * self.scale * self.sculpted.head_radius_m
        solids, blend_m = self.sculpted.solids, mesh.blend_m * sizes
        moved_m = verts_m
        for _ in range(ROUNDS):
            height, slope = surface_distance(self.posed, solids, mesh.near, blend_m, moved_m)
            steep = np.maximum(np.einsum("ni,ni->n", slope, slope), MIN_SLOPE)
            move = np.clip((wanted - height) / steep, -most, most) * (1 - lost)
            moved_m = moved_m + move[:, None] * slope
        return verts_m + smoothed(moved_m - verts_m, mesh.faces, SMOOTHINGS)


def boxes(tree: BodyTree) -> dict[str, tuple[FloatArray, FloatArray]]:
    """Return the opposite corners of the box around each body's solids, in the frame of the body, shape (3,)."""
    corners = {}
    for body in tree.bodies:
        turns = np.array([matrix_from_euler(geom.euler_deg) for geom in body.geoms])
        solids = extents((geom.type, geom.size_m) for geom in body.geoms)
        along = solids.along(turns.transpose(1, 0, 2))  # Reach along each axis of the body, in the solids' frames.
        centres = np.array([geom.pos_m for geom in body.geoms])
        corners[body.name] = (centres - along.T).min(axis=0), (centres + along.T).max(axis=0)
    return corners
