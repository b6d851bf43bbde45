"""Pictures of infants: one in a pose, or several in a row."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Any

import mujoco

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_posed
from mimoc.render.body_camera import FADES_BEHIND_M, STILL, BodyCamera, backdrop_m
from mimoc.render.camera import FOVY_DEG, FROM_THE_FRONT, FROM_THE_SIDE, View, view_of_body
from mimoc.render.markers import Markers, join_markers
from mimoc.render.renderer import Picture, Shown
from mimoc.render.row import row_of
from mimoc.render.scale_bar import with_scale_bar

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
