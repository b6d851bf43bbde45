"""Shapes of mouth and brows in the facial expressions of solids."""

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Face:
    """One expression in the frontal view; lengths are in head radii, heights relative to the centre of the head."""

    smile: float = 0.04
    """Height of the corners of the mouth above its middle."""
    opening: float = 0.0
    """Half of the distance between the lips."""
    mouth_width: float = 0.15
    """Half of the mouth's width."""
    mouth_height: float = -0.50
    """Height of the middle of the mouth."""
    brow_height: float = 0.165
    """Height of the middle of the brows."""
    brow_tilt: float = -0.01
    """Height of the outer end of a brow above its middle."""


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
