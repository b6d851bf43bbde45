"""Drawing of an adult's face: eyes at half of the head's height, small for the head, with brows, nose and full lips."""

import numpy as np
from pictures.cubes import FACE_CELL_PX, FACES, Face, blob, directions, over, within

from mimoc.base.geometry.rotations import FloatArray
from mimoc.compiler.looks.pictures import Colour

SKIN: Colour = (232, 190, 162)
SHADE: Colour = (206, 156, 130)
CHEEK: Colour = (226, 146, 128)
LIP: Colour = (188, 74, 76)
IRIS: Colour = (110, 78, 52)
HAIRLINE: Colour = (69, 46, 31)
BROW: Colour = (150, 108, 74)
INSIDE: Colour = (146, 62, 62)
LID: Colour = (96, 60, 46)
WHITE: Colour = (250, 248, 244)
IRIS_RIM: Colour = (44, 54, 64)
PUPIL: Colour = (22, 18, 20)
BREADTH = 0.65  # Half of the head's breadth by half of its height; features are measured by the latter.
EYE_Y, EYE_Z, EYE_HALF = 0.285, 0.02, (0.15, 0.08)
"""Centre of the eye opening, and its half axes when it is neither wide nor narrow."""
SHOWN = 1.5
"""How much farther than in an infant's face corners of mouth and brows move: an adult's is seen from farther away."""


OPENINGS = {"happy": 0.75, "surprised": 1.45, "scared": 1.4, "angry": 0.75, "disgusted": 0.6, "sad": 0.8}
"""How far the eyes are open, by half of their usual height."""


def draw_adult(expression: str) -> FloatArray:
    """Return the head's cube texture of an adult: one grid of 2 by 3 cells."""
    face = FACES[expression]
    direction = directions(FACE_CELL_PX)
    x, y, z = np.moveaxis(direction, 2, 0)
    y, front = BREADTH * y / 0.8, x > 0
    image = np.full(direction.shape, SKIN, np.float64)
    image = over(image, CHEEK, 0.35 * front * blob(np.abs(y) - 0.36, z + 0.3, 0.16, 0.13))
    image = over(image, SHADE, 0.5 * front * blob(np.abs(y) - 0.06, z + 0.25, 0.05, 0.05))
    image = over(image, SHADE, 0.35 * front * blob(y, z + 0.78, 0.3, 0.09))
    image = over(image, HAIRLINE, within(0.62 - z - 0.5 * np.clip(-x, 0, 1) - 0.1 * np.abs(y), 0.06))
    image = _eyes(image, np.abs(y), z, front, OPENINGS.get(expression, 1.0))
    image = _brows(image, np.abs(y), z, front, face)
    return _mouth(image, y, z, front, face)


def _eyes(image: FloatArray, side: FloatArray, z: FloatArray, front: FloatArray, open_share: float) -> FloatArray:
    across, up = (side - EYE_Y) / EYE_HALF[0], (z - EYE_Z) / (open_share * EYE_HALF[1])
    image = over(image, SHADE, 0.45 * front * blob(side - EYE_Y, z - EYE_Z, 0.17, 0.11))
    radius = np.hypot(across, up)
    image = over(image, LID, front * within(np.hypot(across, up - 0.15) - 1.2, 0.3))
    image = over(image, WHITE, front * within(radius - 0.97, 0.25))
    inside = front * within(radius - 0.97, 0.2)
    ring = np.hypot(side - EYE_Y, z - EYE_Z)
    image = over(image, IRIS_RIM, inside * within(ring - 0.078, 0.02))
    image = over(image, IRIS, inside * within(ring - 0.066, 0.02))
    return over(image, PUPIL, inside * within(ring - 0.036, 0.02))


def _brows(image: FloatArray, side: FloatArray, z: FloatArray, front: FloatArray, face: Face) -> FloatArray:
    across = (side - EYE_Y) / 0.17
    height = 0.2 + SHOWN * (face.brow_height - 0.165) + SHOWN * face.brow_tilt * across - 0.03 * across**2
    thickness = 0.032 * np.clip(1 - 0.6 * across**2, 0, 1)
    return over(image, BROW, front * (np.abs(across) < 1) * within(np.abs(z - height) - thickness, 0.03))


def _mouth(image: FloatArray, y: FloatArray, z: FloatArray, front: FloatArray, face: Face) -> FloatArray:
    width, opening = 1.15 * face.mouth_width + 0.06, 0.8 * SHOWN * face.opening
    across = y / width
    taper = np.sqrt(np.clip(1 - across**2, 0, 1))
    height = z + 0.48 - SHOWN * face.smile * (across**2 - 0.4)
    lip = np.where(height > 0, 0.042, 0.056)
    is_mouth = front * (np.abs(across) < 1)
    image = over(image, LIP, 0.95 * is_mouth * within(np.abs(height) - (opening + lip) * taper, 0.028))
    gap = is_mouth * within(np.abs(height) - np.maximum(opening, 0.009) * taper, 0.026)
    image = over(image, INSIDE, gap)
    teeth = gap * (face.smile > 0.05) * within(np.abs(height - 0.4 * opening) - 0.5 * opening * taper, 0.02)
    return over(image, WHITE, teeth)
