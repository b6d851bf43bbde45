"""Pictures of infants: one in a pose, or several in a row."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
from PIL import Image, ImageDraw, ImageFont

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_posed
from mimoc.render.body_camera import FADES_BEHIND_M, STILL, BodyCamera, backdrop_m
from mimoc.render.camera import FOVY_DEG, FROM_ABOVE, FROM_THE_FRONT, FROM_THE_SIDE, View, view_of_body
from mimoc.render.markers import Markers, join_markers
from mimoc.render.renderer import Picture, Shown
from mimoc.render.row import row_of

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


ROW_FOVY_DEG = 10.0
"""For infants in a row: from so far away that those at the ends do not turn their faces."""


@dataclass(frozen=True, slots=True)
class Framing:
    """Where the camera of a picture stands, and what is around the infants; None is what suits their poses."""

    azimuth_deg: float | None = None
    """Around an infant, or a row: 0 is from its front, 90 from its left; one that lies on its back is seen from beyond
    its feet at 0, one on its belly from beyond its head."""
    elevation_deg: float | None = None
    """Above the horizontal; 90 is from straight above."""
    distance_m: float | None = None
    """From the middle of what is shown; without one, all of it fills the picture."""
    transparent: bool = False
    """Whether only the infants are drawn, without a background or shadows."""
    scale_bar: bool = False
    """Whether a bar says how long something is that is as far away as the middle of the infants."""

    def view(self, usual: View, front_deg: float) -> View:
        """Return the direction to look in, given the one that suits the pose and that of looking at the front."""
        azimuth, elevation = usual
        if self.azimuth_deg is not None:
            azimuth = front_deg + self.azimuth_deg
        return azimuth, elevation if self.elevation_deg is None else -self.elevation_deg


def portrait(
    bundle: Bundle,
    pose: str | None = None,
    width: int = 640,
    height: int = 480,
    markers: Markers | None = None,
    shown: Shown = "skin",
    framing: Framing = Framing(),
) -> Picture:
    """Return a picture of an infant in a pose, shape (height, width, 3), or (height, width, 4) if transparent.

    Args:
        bundle: The infant.
        pose: A keyframe; else the bundle's own.
        width: In pixels.
        height: In pixels.
        markers: What is drawn on top of it, such as the points of its skin.
        shown: Whether it is drawn with its skin, or its solids.
        framing: The camera, a transparent background and a scale bar.

    Raises:
        UnknownNameError: If the bundle has no such pose.
        RenderingError: If there is no OpenGL here.
    """
    model, data = load_posed(bundle, pose)
    root = bundle.manifest.root_body
    front_deg, _ = view_of_body(FROM_THE_FRONT, data, root)
    view = framing.view(view_of_body(FROM_THE_SIDE, data, root), front_deg)
    return _picture(model, data, [root], (width, height), (view, FOVY_DEG), markers, shown, framing)


def lineup(
    bundles: Sequence[Bundle],
    pose: str | None = None,
    width: int = 640,
    height: int = 480,
    markers: Sequence[Markers] | None = None,
    shown: Shown = "skin",
    framing: Framing = Framing(),
) -> Picture:
    """Return a picture of several infants in a row, to scale, shape (height, width, 3), or (..., 4) if transparent.

    They face the same way on a plain floor, whatever their scenes are.

    Args:
        bundles: The infants, from the left.
        pose: A keyframe of all; else of each bundle its own.
        width: In pixels.
        height: In pixels.
        markers: What is drawn on top of each, where it would be if the infant were alone.
        shown: Whether they are drawn with their skins, or their solids.
        framing: The camera, a transparent background and a scale bar.

    Raises:
        UnknownNameError: If a bundle has no such pose.
        RenderingError: If there is no OpenGL here.
    """
    row = row_of(bundles, pose)
    drawn = None
    if markers is not None:
        drawn = join_markers(marker.moved(move.points_m) for marker, move in zip(markers, row.moves, strict=True))
    azimuth, _ = FROM_THE_FRONT
    steepest = min(view_of_body(FROM_THE_FRONT, row.data, root)[1] for root in row.roots)
    view = framing.view((azimuth, steepest), azimuth)
    return _picture(row.model, row.data, row.roots, (width, height), (view, ROW_FOVY_DEG), drawn, shown, framing)


def _picture(
    model: mujoco.MjModel,
    data: mujoco.MjData,
    roots: Sequence[str],
    size_px: tuple[int, int],
    seen_from: tuple[View, float],
    markers: Markers | None,
    shown: Shown,
    framing: Framing,
) -> Picture:
    """Return a picture of bodies, seen in a direction with a vertical field of view."""
    (width, height), (view, fovy_deg), distance_m = size_px, seen_from, framing.distance_m
    fade_m = None if framing.transparent else backdrop_m(model, data, roots, view, width / height, fovy_deg)
    if fade_m is not None and distance_m is not None:
        fade_m = distance_m + FADES_BEHIND_M
    options: Any = {"fovy_deg": fovy_deg, "supersample": STILL, "shown": shown, "fade_m": fade_m}
    with closing(BodyCamera(model, roots, width, height, view, cut_out=framing.transparent, **options)) as camera:
        if len(roots) == 1 and framing.azimuth_deg is None:
            camera.turn(data)
        shot = camera.shot(data)
        if distance_m is not None:
            shot = shot.from_distance(distance_m, fovy_deg)
        picture = camera.render(data, markers, shot)
    return with_scale_bar(picture, shot.px_per_m(height)) if framing.scale_bar else picture


def overview(bundle: Bundle, width: int = 320, height: int = 240) -> Picture:
    """Return a picture of an infant and its toys, from within the room, shape (height, width, 3).

    Raises:
        ModelError: If MuJoCo rejects the model.
        RenderingError: If there is no OpenGL here.
    """
    model, data = load_posed(bundle)
    root, toys = bundle.manifest.root_body, bundle.manifest.toys
    shown = [root, *(toy.body for toy in toys)]
    view = view_of_body(FROM_ABOVE, data, root)
    with closing(BodyCamera(model, shown, width, height, view, supersample=STILL)) as camera:
        camera.turn(data)
        return camera.render(data)
