"""Pictures of infants: one in a pose, one among its toys, or several in a row."""

from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from typing import Literal

import mujoco

from mimoc.base.errors import RenderingError
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import load_model, load_posed
from mimoc.bundle.world import WorldBundle
from mimoc.render.body_camera import BodyCamera, company, view_of_scene
from mimoc.render.camera import FOVY_DEG, FROM_ABOVE, FROM_THE_FRONT, FROM_THE_SIDE, MARGIN, View, view_of_body
from mimoc.render.framing import FILLED, FILLED_BY_HEAD, portrait_view, view_of_head
from mimoc.render.markers import Markers, join_markers
from mimoc.render.picture_files import with_scale_bar
from mimoc.render.picture_poses import load_world_in_pose, state_in_pose
from mimoc.render.renderer import Picture, Shown
from mimoc.render.row import row_of
from mimoc.render.soft_light import ROW, STILL

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
    crop: Literal["head"] | None = None
    """Whether the head alone fills the picture."""

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

    The pose is a keyframe, by default the bundle's own; markers are drawn on top of it, such as the points of its skin.
    Raises an UnknownNameError for an unknown pose, a RenderingError without OpenGL.
    """
    (picture,) = portraits(bundle, [pose], width, height, markers, shown, framing)
    return picture


def portraits(
    bundle: Bundle,
    poses: Sequence[str | None],
    width: int = 640,
    height: int = 480,
    markers: Markers | None = None,
    shown: Shown = "skin",
    framing: Framing = Framing(),
) -> Iterator[Picture]:
    """Yield pictures of an infant in several poses, in less time than one after another takes; see `portrait`."""
    model, manifest = load_model(bundle), bundle.manifest
    states = [state_in_pose(bundle, model, pose) for pose in poses]
    beside = () if framing.crop else company(manifest, [manifest.root_body], states[0])
    margin = MARGIN if beside else 1 / (FILLED_BY_HEAD if framing.crop else FILLED)
    camera = BodyCamera(
        *(model, [manifest.root_body], width, height),
        exposure=STILL, margin=margin, shown=shown, cut_out=framing.transparent, beside=beside, as_it_is=True,
    )  # fmt: skip
    with closing(camera):
        for data in states:
            root, head = manifest.root_body, manifest.anatomy.head
            subject = _subject(manifest, framing)
            front_deg, _ = view_of_body(FROM_THE_FRONT, data, root)
            if framing.crop:
                usual = view_of_head(data, subject)
            elif isinstance(manifest, Manifest) and manifest.caregiver:
                usual = view_of_scene(FROM_THE_SIDE, manifest, [root], data)
            else:
                usual = portrait_view(data, root, head)
            camera.view = framing.view(usual, front_deg)
            yield _picture(camera, data, [_subject(manifest, framing)], FOVY_DEG, markers, framing, is_tight=not beside)


def _subject(manifest: Manifest, framing: Framing) -> str:
    if not framing.crop:
        return manifest.root_body
    if manifest.anatomy.head is None:
        raise RenderingError(f"'{manifest.name}' has no head to draw; leave out --crop head")
    return manifest.anatomy.head


def world_portrait(
    bundle: WorldBundle,
    pose: str | None = None,
    width: int = 640,
    height: int = 480,
    markers: Markers | None = None,
    shown: Shown = "skin",
    framing: Framing = Framing(),
) -> Picture:
    """Return a picture of several infants in their world, by default as they start; see `portrait`.

    Raises:
        UnknownNameError: If an infant cannot have the pose, a start pose of all.
        RenderingError: If there is no OpenGL here.
    """
    model, data = load_world_in_pose(bundle, pose)
    roots = [infant.manifest.root_body for infant in bundle.infants.values()]
    front_deg, _ = view_of_body(FROM_THE_FRONT, data, roots[0])
    view = framing.view(view_of_scene(FROM_THE_SIDE, bundle.manifest, roots, data), front_deg)
    beside = company(bundle.manifest, roots, data)
    camera = BodyCamera(
        *(model, roots, width, height, view),
        exposure=STILL, shown=shown, cut_out=framing.transparent, beside=beside, as_it_is=True,
    )  # fmt: skip
    with closing(camera):
        return _picture(camera, data, roots, FOVY_DEG, markers, framing)


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

    They face the same way on a plain floor, whatever their scenes are, from the left; markers are drawn where they
    would be if each were alone. Raises what `portrait` does.
    """
    model, data, roots, moves = row_of(bundles, pose)
    drawn = None
    if markers is not None:
        drawn = join_markers(marker.moved(move.points_m) for marker, move in zip(markers, moves, strict=True))
    azimuth, _ = FROM_THE_FRONT
    steepest = min(view_of_body(FROM_THE_FRONT, data, root)[1] for root in roots)
    view = framing.view((azimuth, steepest), azimuth)
    camera = BodyCamera(
        *(model, roots, width, height, view),
        fovy_deg=ROW_FOVY_DEG, exposure=ROW, shown=shown, cut_out=framing.transparent, as_it_is=True,
    )  # fmt: skip
    with closing(camera):
        return _picture(camera, data, roots, ROW_FOVY_DEG, drawn, framing)


def _picture(
    camera: BodyCamera,
    data: mujoco.MjData,
    bodies: Sequence[str],
    fovy_deg: float,
    markers: Markers | None,
    framing: Framing,
    *,
    is_tight: bool = False,
) -> Picture:
    """Return a picture of bodies, with a vertical field of view; tight ones leave out what only might be drawn."""
    if len(bodies) == 1 and framing.azimuth_deg is None:
        camera.turn(data)
    shot = camera.shot(data, camera.drawn(data, bodies) if is_tight else None)
    if framing.distance_m is not None:
        shot = shot.from_distance(framing.distance_m, fovy_deg)
    picture = camera.render(data, markers, shot)
    return with_scale_bar(picture, shot.px_per_m(len(picture))) if framing.scale_bar else picture


def overview(bundle: Bundle, width: int = 320, height: int = 240) -> Picture:
    """Return a picture of an infant and its toys, from within the room, shape (height, width, 3).

    Raises:
        ModelError: If MuJoCo rejects the model.
        RenderingError: If there is no OpenGL here.
    """
    model, data = load_posed(bundle)
    root, toys = bundle.manifest.root_body, bundle.manifest.toys
    shown = [root, *(toy.body for toy in toys)]
    view, beside = view_of_scene(FROM_ABOVE, bundle.manifest, [root], data), company(bundle.manifest, [root], data)
    with closing(BodyCamera(model, shown, width, height, view, exposure=STILL, beside=beside, as_it_is=True)) as camera:
        camera.turn(data)
        return camera.render(data)
