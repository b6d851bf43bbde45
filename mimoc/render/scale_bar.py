"""A bar of a round length in the corner of a picture."""

import numpy as np
from PIL import Image, ImageDraw, ImageFont

from mimoc.render.picture_grid import Picture

LENGTHS_CM = (1, 2, 5, 10, 20, 50, 100, 200, 500)
"""Of bars: the longest that fits, or the shortest."""
SHARE = 0.3
"""Of the width of a picture that a bar takes at most."""
COLOUR, RIM = (20, 20, 20, 255), (255, 255, 255, 255)
"""Dark with a light rim, which shows on any background."""
LETTERS = 0.04
"""Height of the letters, as a share of the picture's."""
LETTERS_PX = 9, 60


def bar_length_cm(width_px: int, px_per_m: float) -> int:
    """Return how long the bar of a picture is."""
    return max(
        (length_cm for length_cm in LENGTHS_CM if length_cm / 100 * px_per_m <= SHARE * width_px), default=LENGTHS_CM[0]
    )


def with_scale_bar(picture: Picture, px_per_m: float) -> Picture:
    """Return a picture with a bar and its length in its lower left corner.

    Args:
        picture: Shape (height, width, 3), or (height, width, 4) with opacity.
        px_per_m: Pixels of a metre at the distance of what it shows.
    """
    height, width, _ = picture.shape
    length_cm = bar_length_cm(width, px_per_m)
    letters_px = int(np.clip(LETTERS * height, *LETTERS_PX))
    thick_px, rim_px = max(letters_px // 4, 2), max(letters_px // 12, 1)
    image = Image.fromarray(picture)
    pen = ImageDraw.Draw(image)
    left, bottom = letters_px, height - letters_px
    right = left + max(round(length_cm / 100 * px_per_m), 1) - 1  # Pillow draws both ends.
    top = bottom - thick_px + 1
    pen.rectangle((left - rim_px, top - rim_px, right + rim_px, bottom + rim_px), RIM)
    pen.rectangle((left, top, right, bottom), COLOUR)
    where = (left + right) / 2, top - rim_px - letters_px // 4
    text = f"{length_cm} cm"
    pen.text(where, text, COLOUR, ImageFont.load_default(letters_px), "mb", stroke_width=rim_px, stroke_fill=RIM)
    return np.asarray(image)
