"""Drawing of the textures of an infant's solids, in inks: face, eyes, ears and clothes."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pictures.inks import ink, mixed, plain

from mimoc.base.geometry.rotations import FloatArray
from mimoc.base.geometry.solvers import smoothstep
from mimoc.compiler.looks.appearance import GRID_LAYOUT
from mimoc.compiler.looks.pictures import Colour


@dataclass(frozen=True, slots=True)
class Face:
    """One expression in the frontal view; lengths are in head radii, heights relative to the centre of the head."""

    smile: float = 0.04  # Height of the corners of the mouth above its middle.
    opening: float = 0.0  # Half of the distance between the lips.
    mouth_width: float = 0.15  # Half of the mouth's width.
    mouth_height: float = -0.50  # Height of the middle of the mouth.
    brow_height: float = 0.165  # Height of the middle of the brows.
    brow_tilt: float = -0.01  # Height of the outer end of a brow above its middle.


FACES = {
    "neutral": Face(),
    "happy": Face(smile=0.10, opening=0.035, mouth_width=0.25, brow_height=0.19, brow_tilt=-0.02),
    "sad": Face(smile=-0.08, mouth_width=0.2, brow_height=0.18, brow_tilt=-0.055),
    "surprised": Face(
        smile=0.0, opening=0.085, mouth_width=0.12, mouth_height=-0.54, brow_height=0.25, brow_tilt=-0.01
    ),
    "angry": Face(smile=-0.05, opening=0.02, mouth_width=0.2, brow_height=0.14, brow_tilt=0.06),
    "disgusted": Face(
        smile=-0.09, opening=0.03, mouth_width=0.17, mouth_height=-0.45, brow_height=0.12, brow_tilt=0.01
    ),
    "scared": Face(smile=-0.04, opening=0.055, mouth_width=0.23, brow_height=0.24, brow_tilt=-0.06),
    "sleepy": Face(smile=0.02, opening=0.02, mouth_width=0.12, brow_height=0.15, brow_tilt=-0.035),
    "crying": Face(smile=-0.03, opening=0.10, mouth_width=0.22, mouth_height=-0.52, brow_height=0.17, brow_tilt=-0.075),
}
"""Face by name of the expression."""


FACE_CELL_PX = 85  # Size of a cell, of which three are in a row.
EYE_CELL_PX = 48
EAR_CELL_PX = 20
CLOTH_CELL_PX = 60
STRIPES = 8  # Number of stripes around a capsule; with an even number, front and back look alike.

# MuJoCo looks a cube texture up as OpenGL does, with the geom's own x, y and z: found by rendering a coded
# sphere from six sides. Each cell is (outward axis, direction of its columns, direction of its rows), so the
# face of a head that looks along +x is the cell R, seen lying on its side.
CELLS = {
    "R": ((1, 0, 0), (0, 0, -1), (0, -1, 0)),
    "L": ((-1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "U": ((0, 1, 0), (1, 0, 0), (0, 0, 1)),
    "D": ((0, -1, 0), (1, 0, 0), (0, 0, -1)),
    "F": ((0, 0, 1), (1, 0, 0), (0, -1, 0)),
    "B": ((0, 0, -1), (-1, 0, 0), (0, -1, 0)),
}

SKIN, BLUSH, LIP, LID, WHITE, HAIR = map(ink, ("skin", "blush", "lip", "lash", "white", "hair"))
INSIDE, IRIS, IRIS_RIM, IRIS_LIGHT = map(ink, ("inside", "iris", "iris_rim", "iris_light"))
PUPIL, GLINT = ink("pupil"), ink("glint")
EAR = mixed(skin=0.77, blush=0.23)
EAR_HOLLOW = mixed(skin=0.3, shade=0.4, blush=0.3)
SHIRT, STRIPE = ink("shirt"), ink("stripe")

EYE_Y, EYE_Z = 0.352, -0.090  # Centre of the eye opening in the frontal view, in head radii.


def draw_face(expression: str, breadth: float = 1.0) -> FloatArray:
    """Return the head's cube texture in inks: one grid of 2 by 3 cells.

    Args:
        expression: A key of `FACES`.
        breadth: Half of the head's breadth in head radii; the features of the face are as wide on any head.
    """
    face = FACES[expression]
    direction = directions(FACE_CELL_PX)
    x, y, z = np.moveaxis(direction, 2, 0)
    y = breadth * y
    image = brow(_bare_head(breadth), np.abs(y), z, x > 0, face)
    return mouth(image, y, z, x > 0, face)


def draw_eye() -> FloatArray:
    """Return the eyeball's cube texture, with the pupil along +x."""
    return _paint_cube(EYE_CELL_PX, _eye_colour)


def draw_ear() -> FloatArray:
    """Return an ear's cube texture: a rim around a hollow, alike on both faces across y."""
    return _paint_cube(EAR_CELL_PX, _ear_colour)


def draw_stripes() -> FloatArray:
    """Return a capsule's cube texture: stripes that run along its axis, z.

    A 2D texture would do, but MuJoCo 3.5 and 3.17 lay those around a capsule in different ways.
    """
    return _paint_cube(CLOTH_CELL_PX, _cloth_colour)


def directions(cell_px: int) -> FloatArray:
    """Return the direction of each texel of the grid, unit vectors, shape `(2 * cell_px, 3 * cell_px, 3)`."""
    steps = (np.arange(cell_px, dtype=np.float64) + 0.5) / cell_px * 2 - 1
    along = steps[None, :, None]
    down = steps[:, None, None]
    axes = [np.asarray(CELLS[letter], np.float64) for letter in GRID_LAYOUT]
    cells = [out + along * right + down * below for out, right, below in axes]
    grid = np.vstack([np.hstack(cells[:3]), np.hstack(cells[3:])])
    return grid / np.linalg.norm(grid, axis=2, keepdims=True)


def _paint_cube(cell_px: int, colour: Callable[[FloatArray], FloatArray]) -> FloatArray:
    """Return a cube texture whose colour is a function of direction, so that it has no seams."""
    return colour(directions(cell_px))


def _bare_head(breadth: float) -> FloatArray:
    """Return the parts of the head that all expressions share: skin, hair and lids.

    By direction from its centre: x forward, y left, z up.
    """
    direction = directions(FACE_CELL_PX)
    x, y, z = np.moveaxis(direction, 2, 0)
    front, side = x > 0, breadth * np.abs(y)
    image = blush(plain(direction.shape, SKIN), breadth * y, z, front)
    image = hair(image, x, y, z)
    return _eye_opening(image, side, z, front)


def blush(image: FloatArray, y: FloatArray, z: FloatArray, front: FloatArray) -> FloatArray:
    """Redden the cheeks and the tip of the nose."""
    image = over(image, BLUSH, 0.42 * front * blob(np.abs(y) - 0.53, z + 0.36, 0.17, 0.14))
    return over(image, BLUSH, 0.18 * front * blob(y, z + 0.27, 0.09, 0.08))


def hair(image: FloatArray, x: FloatArray, y: FloatArray, z: FloatArray) -> FloatArray:
    """Draw thin hair on the crown and the back of the head, with strands that radiate from the whorl."""
    whorl_x, whorl_z = -0.6, 0.8
    angle = np.arccos(np.clip(whorl_x * x + whorl_z * z, -1, 1))
    around = np.arctan2(np.abs(y), whorl_z * x - whorl_x * z)
    waves = 0.6 * np.sin(23 * around + 3 * angle) + 0.4 * np.sin(59 * around - 5 * angle)
    strands = waves * np.clip(2 * angle, 0, 1)  # At the whorl, they would be finer than a texel.
    reach = 1.18 + 0.08 * strands
    return over(image, HAIR, (0.62 + 0.10 * strands) * within(angle - reach, 0.45))


def _eye_opening(image: FloatArray, side: FloatArray, z: FloatArray, front: FloatArray) -> FloatArray:
    """Draw the lids and the white around each eyeball; the eyeball itself is another geom."""
    across, up = (side - EYE_Y) / 0.145, (z - EYE_Z) / 0.118
    image = over(image, BLUSH, 0.30 * front * blob(side - EYE_Y, z - EYE_Z, 0.22, 0.19))
    lashes = np.hypot(across, up - 0.12) - 1.12
    image = over(image, LID, 0.9 * front * np.clip(0.4 + up, 0.2, 1) * within(lashes, 0.34))
    return over(image, WHITE, front * within(np.hypot(across, up) - 0.98, 0.26))


def brow(image: FloatArray, side: FloatArray, z: FloatArray, front: FloatArray, face: Face) -> FloatArray:
    """Draw a short, soft brow over each eye; a positive tilt lowers its inner end."""
    across = (side - 0.37) / 0.17
    middle = face.brow_height + face.brow_tilt * across - 0.035 * across**2
    thickness = 0.026 * np.clip(1 - across**2, 0, 1)
    strength = 0.7 * front * np.clip(1.3 - across**2, 0, 1)
    return over(image, HAIR, strength * (np.abs(across) < 1) * within(np.abs(z - middle) - thickness, 0.03))


def mouth(image: FloatArray, y: FloatArray, z: FloatArray, front: FloatArray, face: Face) -> FloatArray:
    """Draw the lips, and the inside of the mouth if it is open."""
    across = y / face.mouth_width
    taper = np.sqrt(np.clip(1 - across**2, 0, 1))
    height = z - face.mouth_height - face.smile * (across**2 - 0.4)
    bow = 0.014 * np.exp(-((across / 0.16) ** 2))
    lip = np.where(height > 0, 0.046 - bow, 0.058)
    mouth = front * (np.abs(across) < 1)
    gap = mouth * within(np.abs(height) - np.maximum(face.opening, 0.006) * taper, 0.032)
    image = over(image, LIP, 0.85 * mouth * within(np.abs(height) - (face.opening + lip) * taper, 0.032))
    return over(image, INSIDE, gap)


def _eye_colour(direction: FloatArray) -> FloatArray:
    """Return the colour of an eyeball by direction from its centre; the pupil is at +x."""
    x, y, z = np.moveaxis(direction, 2, 0)
    angle = np.degrees(np.arccos(np.clip(x, -1, 1)))
    around = np.arctan2(z, y)
    white = mixed(white=0.86, skin=0.06, shade=0.08)
    image = over(plain(direction.shape, white), mixed(white=0.5, shade=0.5), 0.22 * within(34 - angle, 30))
    image = over(image, IRIS_RIM, 0.9 * within(angle - 42, 5))
    image = over(image, IRIS, within(angle - 37, 6))
    rays = 0.5 + 0.5 * np.sin(17 * around) * np.sin(7 * around + 1)
    image = over(image, IRIS_LIGHT, 0.55 * within(np.abs(angle - 27) - 4, 10) * rays * within(z - 0.1, 0.7))
    image = over(image, PUPIL, within(angle - 19, 4))
    image = over(image, mixed(pupil=0.6, shade=0.4), 0.34 * within(0.36 - z, 0.30) * within(angle - 80, 20))
    image = over(image, GLINT, 0.95 * within(np.hypot(y - 0.17, z - 0.22) - 0.085, 0.06) * (x > 0))
    return over(image, GLINT, 0.35 * within(np.hypot(y + 0.20, z + 0.24) - 0.05, 0.08) * (x > 0))


def _ear_colour(direction: FloatArray) -> FloatArray:
    """Return the colour of an ear by direction from its centre; its hollow faces along y."""
    x, _, z = np.moveaxis(direction, 2, 0)
    hollow = np.hypot(x / 0.55, (z - 0.12) / 0.62) - 1
    return over(plain(direction.shape, EAR), EAR_HOLLOW, 0.8 * within(hollow, 0.5))


def _cloth_colour(direction: FloatArray) -> FloatArray:
    """Return the colour of striped cloth by direction from the centre of a capsule along z."""
    x, y, _ = np.moveaxis(direction, 2, 0)
    wave = np.cos(STRIPES * np.arctan2(y, x))
    return over(plain(direction.shape, SHIRT), STRIPE, within(0.45 - wave, 0.5))


def blob(across: FloatArray, up: FloatArray, width: float, height: float) -> FloatArray:
    """Return a soft spot of the given half-widths, 1 in the middle."""
    return np.exp(-((across / width) ** 2) - (up / height) ** 2)


def within(distance: FloatArray, edge: float) -> FloatArray:
    """Return 1 where *distance* is negative and 0 where it is positive, blended over *edge*.

    The blend is as wide as a texel or more, so the drawing needs no supersampling.
    """
    return smoothstep(0.5 - distance / edge)


def over(image: FloatArray, colour: Colour | FloatArray, coverage: FloatArray) -> FloatArray:
    """Return *image* blended with *colour*; *coverage* is its opacity, 0 to 1, shape `(rows, columns)`.

    Image and colour are of red, green and blue, or mixtures of inks.
    """
    return image + coverage[..., None] * (np.asarray(colour, np.float64) - image)
