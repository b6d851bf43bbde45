"""The pictures of the head's skin: one for each expression, painted on the mesh's surface. Lengths are mm."""

from dataclasses import dataclass, field

import numpy as np
from faces import MESHED, SHAPES
from fields import Array
from head import LID, MOUTH_HALF, Head, folded, lip_tubes, opening
from head_mesh import PATCH, wrapped
from pictures.cubes import BLUSH, HAIR, INSIDE, LIP, SKIN, over as laid_over, within
from pictures.inks import Painted, ink, mixed, plain, with_palette
from scipy.ndimage import distance_transform_edt

from mimoc.compiler.looks.sculpture import template_mesh

FACE_PX = 320  # Sides of the picture of a face.
COLOURS = 128
AS_SHOWN = np.cos(np.radians(15.0))  # Least cosine of the angle between a place and the direction that its texel shows.
LASH, SHADE, TONGUE = ink("lash"), ink("shade"), ink("tongue")
LIPS = mixed(lip=0.6, blush=0.4)
LID_RIM = mixed(lip=0.3, blush=0.2, skin=0.5)


@dataclass(frozen=True, slots=True)
class Paint:
    """What differs between the pictures of expressions; shares of inks, 0 to 1. All are by eye (D)."""

    cheeks: float = 0.34  # Redness of the cheeks.
    face: float = 0.0  # Redness of the whole face.
    eyes: float = 0.0  # Redness around the eyes.
    brows: float = 0.50  # Strength of the brows.
    frown: float = 0.0  # Of the folds between the brows.
    nose: float = 0.0  # Of the folds beside the nose.
    lids: float = 0.85  # Of the lashes.
    lash_mm: float = 0.75  # Breadth of the upper lashes.


PAINTS = {
    "neutral": Paint(),
    "happy": Paint(cheeks=0.46, brows=0.52),
    "sad": Paint(cheeks=0.30, eyes=0.12, brows=0.6, frown=0.12),
    "surprised": Paint(brows=0.6),
    "angry": Paint(cheeks=0.42, face=0.10, brows=0.75, frown=0.40, nose=0.15),
    "disgusted": Paint(brows=0.62, frown=0.25, nose=0.42),
    "scared": Paint(cheeks=0.18, brows=0.65, frown=0.15),
    "sleepy": Paint(eyes=0.10, lids=0.95, lash_mm=1.0),
    "crying": Paint(cheeks=0.55, face=0.22, eyes=0.25, brows=0.65, frown=0.32, nose=0.38, lids=1.0, lash_mm=1.6),
}
"""Paint by name of the expression."""


@dataclass(frozen=True)
class Canvas:
    """The places on the head that the texels of a picture show, folded onto its right side."""

    places: Array  # Shape (rows, columns, 3).
    head: Head
    image: Array = field(repr=False)  # Mixtures of inks, shape (rows, columns, inks).

    def near(self, place: tuple[float, float, float], size: tuple[float, float, float]) -> Array:
        """Return 1 at a place, given with y positive, and less and less around it, shape (rows, columns)."""
        far = (self.places - np.array(place) * (1, -1, 1)) / size
        return np.exp(-(far**2).sum(axis=2))

    def values(self, function) -> Array:
        """Return a function of points at all texels, shape (rows, columns)."""
        return function(self.places.reshape(-1, 3)).reshape(self.places.shape[:2])

    def over(self, mixture: Array, coverage: Array) -> None:
        """Lay a colour over the picture."""
        self.image[:] = laid_over(self.image, mixture, np.clip(coverage, 0, 1))


def paint_face(expression: str) -> Painted:
    """Return the skin of the head with an expression, a key of `PAINTS`; see `uv_map`."""
    paint = PAINTS[expression]
    places, head = _places()
    canvas = Canvas(places, head, plain(places.shape, SKIN))
    _skin(canvas, paint)
    _folds(canvas, paint)
    _brows(canvas, paint)
    _lids(canvas, paint)
    _lips(canvas)
    _pocket(canvas)
    return with_palette(canvas.image, COLOURS)


def _skin(canvas: Canvas, paint: Paint) -> None:
    tip_x, tip_z, _ = SHAPES[MESHED].tip
    canvas.over(BLUSH, paint.face * canvas.near((74, 0, -22), (40, 46, 46)))
    canvas.over(BLUSH, paint.cheeks * canvas.near((64, 33, -32), (24, 15, 13)))
    canvas.over(BLUSH, 0.20 * canvas.near((tip_x + 5, 0, tip_z), (8, 8, 6)))
    canvas.over(BLUSH, 0.14 * canvas.near((64, 0, SHAPES[MESHED].chin[1]), (12, 12, 9)))
    ear = canvas.near((-6, 66, -13), (15, 8, 22))
    canvas.over(BLUSH, 0.30 * ear)
    canvas.over(SHADE, 0.30 * canvas.near((-4, 63, -12), (8, 5, 12)))
    canvas.over(
        BLUSH, (0.10 + paint.eyes) * canvas.near(tuple(canvas.head.eye * (1, -1, 1) + (10, 0, 0)), (16, 16, 12))
    )


def _folds(canvas: Canvas, paint: Paint) -> None:
    """Draw nostrils, and what frowns and cries fold."""
    tip_x, tip_z, _ = SHAPES[MESHED].tip
    canvas.over(mixed(shade=0.5, inside=0.5), 0.75 * canvas.near((tip_x - 0.8, 3.2, tip_z - 5.4), (4, 1.7, 1.5)))
    canvas.over(SHADE, 0.16 * canvas.near((tip_x - 6, 9.5, tip_z - 3), (6, 2.2, 4)))
    canvas.over(SHADE, paint.frown * canvas.near((78, 4.0, 7), (8, 1.3, 6)))
    y, z = -canvas.places[..., 1], canvas.places[..., 2]
    beside = y - (9.5 + 0.62 * (tip_z - 1 - z))
    along = within(z - (tip_z + 1), 4) * within(tip_z - 17 - z, 6)
    canvas.over(SHADE, paint.nose * (canvas.places[..., 0] > 45) * along * np.exp(-((beside / 1.7) ** 2)))


def _brows(canvas: Canvas, paint: Paint) -> None:
    """Draw thin brows of short strokes."""
    y, z = -canvas.places[..., 1], canvas.places[..., 2]
    across = np.clip((y - 11) / 24, -0.5, 1.5)
    middle = 8.6 + 5.4 * across - 5.6 * across**2
    strokes = 0.78 + 0.22 * np.sin(2.4 * y + 1.9 * (z - middle))
    thick = 1.25 * np.clip(1.15 - 0.9 * across**2, 0, 1) * np.clip(1 + 4 * across, 0, 1)
    is_brow = (across > -0.1) & (across < 1.05) & (canvas.places[..., 0] > 40)
    ends = within(0.03 - across, 0.16) * within(across - 0.98, 0.3)
    canvas.over(HAIR, paint.brows * is_brow * ends * strokes * within(np.abs(z - middle) - thick, 1.9))


def _lids(canvas: Canvas, paint: Paint) -> None:
    """Draw the rims of the lids, lashes along the upper one, and the fold above it."""
    head = canvas.head
    inside = canvas.values(opening(head))
    from_eye = canvas.places - head.eye
    close = within(np.linalg.norm(from_eye, axis=2) - 1.7 * head.eye_radius, 2) * (from_eye[..., 0] > 0)
    upper = within(-from_eye[..., 2] - 0.3, 1.5)
    canvas.over(SHADE, 0.20 * close * upper * np.exp(-(((inside + 4.3) / 0.9) ** 2)))
    canvas.over(SHADE, 0.10 * close * (1 - upper) * np.exp(-(((inside + 3.2) / 1.2) ** 2)))
    canvas.over(LID_RIM, close * (0.55 - 0.25 * upper) * within(-inside - 0.5, 0.9))
    outer = np.clip(0.75 - 0.05 * from_eye[..., 1], 0.4, 1)
    canvas.over(LASH, paint.lids * outer * close * upper * within(-inside - paint.lash_mm * outer, 0.9))


def _lips(canvas: Canvas) -> None:
    """Draw the lips where their relief is, and the line between them."""
    upper, lower = (canvas.values(lip) for lip in lip_tubes(canvas.head, SHAPES[MESHED]))
    front = canvas.places[..., 0] > 45
    aside, z = -canvas.places[..., 1], canvas.places[..., 2]
    inner = within(aside - MOUTH_HALF + 1, 1) * within(np.abs(z - SHAPES[MESHED].mouth[1]) - 3, 2)
    red = front * np.maximum(
        within(np.minimum(upper, lower) - 0.2, 1.9), inner * within(np.abs(lower - upper) - 1.2, 1)
    )
    canvas.over(LIPS, 0.62 * red)
    canvas.over(LIP, 0.22 * red * within(upper - lower, 1.0))
    between = red * np.exp(-(((lower - upper) / 1.2) ** 2))
    canvas.over(INSIDE, 0.48 * between)


def _pocket(canvas: Canvas) -> None:
    """Draw the inside of the mouth in a corner of the picture."""
    steps = (np.arange(FACE_PX) + 0.5) / FACE_PX
    across, up = np.meshgrid((steps - PATCH[0]) / PATCH[1], (steps[::-1] - PATCH[0]) / PATCH[1])
    far = np.hypot(across, up)
    patch = within(far - 1.12, 0.05)
    canvas.over(mixed(inside=0.8, lash=0.2), patch)
    canvas.over(mixed(lip=0.7, inside=0.3), 0.8 * patch * within(0.93 - far, 0.2))
    canvas.over(TONGUE, 0.85 * patch * within(np.hypot(across / 0.66, (up + 0.52) / 0.42) - 1, 0.3))


def _places() -> tuple[Array, Head]:
    """Return the places on the reference head that the texels show; between the lids, the nearest lid's."""
    sculpted = template_mesh("mitten").head
    head = Head(1000 * sculpted.half_axes_m, 1000 * sculpted.eye_m, 1000 * sculpted.eye_radius_m)
    verts = 1000 * sculpted.at_ages_m[list(SHAPES).index(MESHED)]
    shown = np.full((FACE_PX, FACE_PX, 3), np.nan)
    corners = sculpted.texcoords * (FACE_PX, -FACE_PX) + (-0.5, FACE_PX - 0.5)
    steps = (np.arange(FACE_PX) + 0.5) / FACE_PX
    ways = wrapped(np.stack(np.meshgrid(steps, steps[::-1]), axis=-1))
    for face in sculpted.faces:
        _fill(shown, ways, corners[face], verts[face], head)
    shown = _between_lids(shown, ways, head)
    missing = np.isnan(shown[..., 0])
    rows, columns = distance_transform_edt(missing, return_distances=False, return_indices=True)
    return folded(shown[rows, columns].reshape(-1, 3)).reshape(shown.shape), head


def _between_lids(shown: Array, ways: Array, head: Head) -> Array:
    """Return places of which those that no triangle covers are on closed lids, where there are such."""
    for sign in (1, -1):
        eye, along = head.eye * (1, sign, 1), ways * head.half_axes
        square, half = (along**2).sum(axis=-1), along @ eye
        under = half**2 - square * (eye @ eye - (LID * head.eye_radius) ** 2)
        is_lid = np.isnan(shown[..., 0]) & (under > 0) & (half > 0)
        far = (half + np.sqrt(np.maximum(under, 0))) / square
        shown = np.where(is_lid[..., None], far[..., None] * along, shown)
    return shown


def _fill(shown: Array, ways: Array, corners: Array, verts: Array, head: Head) -> None:
    """Write the places within a triangle, shape (3, 3), at the texels that it covers; what is farther out stays.

    Only where these are about in the direction that the texels show: at the picture's end, triangles are wide.
    """
    low = np.maximum(np.ceil(corners.min(axis=0) - 0.01).astype(int), 0)
    high = np.minimum(np.floor(corners.max(axis=0) + 0.01).astype(int), FACE_PX - 1)
    columns, rows = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
    if not columns.size:
        return
    edges = np.column_stack((corners[1] - corners[0], corners[2] - corners[0]))
    if abs(np.linalg.det(edges)) < 1e-9:
        return
    shares = np.stack((columns, rows), axis=-1) - corners[0]
    second, third = np.moveaxis(shares @ np.linalg.inv(edges).T, 2, 0)
    covered = (second > -0.01) & (third > -0.01) & (second + third < 1.01)
    places = verts[0] + second[..., None] * (verts[1] - verts[0]) + third[..., None] * (verts[2] - verts[0])
    before = np.linalg.norm(np.nan_to_num(shown[rows, columns]), axis=-1)
    along = places / head.half_axes
    along = along / np.linalg.norm(along, axis=-1, keepdims=True)
    covered &= (along * ways[rows, columns]).sum(axis=-1) > AS_SHOWN
    covered &= np.linalg.norm(places, axis=-1) > before
    shown[rows[covered], columns[covered]] = places[covered]
