"""Pictures of infants: one in a pose, or several in a row."""

from collections.abc import Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import accumulate
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_posed
from mimoc.bundle.strangers import check_files
from mimoc.render.body_camera import FADES_BEHIND_M, STILL, BodyCamera, backdrop_m
from mimoc.render.camera import FOVY_DEG, FROM_THE_FRONT, FROM_THE_SIDE, View, heading_deg, view_of_body
from mimoc.render.markers import Markers, join_markers
from mimoc.render.renderer import Picture, Shown
from mimoc.render.scale_bar import with_scale_bar
from mimoc.units import cm_to_m

ROW_FOVY_DEG = 10.0
"""For infants in a row: from so far away that those at the ends do not turn their faces."""
GAP_IN_LENGTHS = 0.5
"""Distance of infants in a row, as a share of their length."""
SKIN = ".skn"
"""Ending of the files of skins: infants in a row share textures, but no skins."""
SEPARATOR = ": "
"""Between the number of an infant in a row and the names of its parts."""
BESIDE_M = 1.0
"""How far beyond the ends of a row things cast shadows."""


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
    front_deg = FROM_THE_FRONT[0] + heading_deg(data, root)
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
    posed = [load_posed(bundle, pose) for bundle in bundles]
    places_m = _places_m(bundles)
    model, roots = _in_a_row(bundles, places_m)
    data = mujoco.MjData(model)
    for (alone, state), root, y_m in zip(posed, roots, places_m, strict=True):
        _take_pose(model, data, root.rpartition(SEPARATOR)[0], (alone, state), y_m)
    mujoco.mj_forward(model, data)
    drawn = None
    if markers is not None:
        drawn = join_markers(each.moved(np.array((0.0, y_m, 0.0))) for each, y_m in zip(markers, places_m, strict=True))
    azimuth, _ = FROM_THE_FRONT
    steepest = min(view_of_body(FROM_THE_FRONT, data, root)[1] for root in roots)
    view = framing.view((azimuth, steepest), azimuth)
    return _picture(model, data, roots, (width, height), (view, ROW_FOVY_DEG), drawn, shown, framing)


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


def _take_pose(
    row: mujoco.MjModel, data: mujoco.MjData, number: str, alone: tuple[mujoco.MjModel, mujoco.MjData], y_m: float
) -> None:
    """Give an infant in a row the pose that it has alone, some way to the left; toys are those of the first."""
    model, state = alone
    prefix = number + SEPARATOR if number else ""
    for joint in range(model.njnt):
        name = model.joint(joint).name
        if mujoco.mj_name2id(row, mujoco.mjtObj.mjOBJ_JOINT, prefix + name) < 0:
            continue
        data.joint(prefix + name).qpos[:] = state.joint(joint).qpos
        if model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_FREE:
            data.joint(prefix + name).qpos[1] += y_m


def _places_m(bundles: Sequence[Bundle]) -> list[float]:
    """Return where each infant stands in a row, along y."""
    halves_m = [cm_to_m(GAP_IN_LENGTHS * bundle.manifest.child.length_cm / 2) for bundle in bundles]
    return list(accumulate((half + before for half, before in zip(halves_m[1:], halves_m, strict=False)), initial=0.0))


def _in_a_row(bundles: Sequence[Bundle], places_m: Sequence[float]) -> tuple[mujoco.MjModel, list[str]]:
    """Return a model of several infants in the world of the first, and the roots of their bodies."""
    for bundle in bundles:
        check_files(bundle)
    first = bundles[0]
    files = {name: file for number, bundle in enumerate(bundles) for name, file in _assets(bundle, number).items()}
    row = mujoco.MjSpec.from_string(_text(first, first.manifest.scene), include=dict(first.files), assets=files)
    for key in row.keys:
        row.delete(key)
    roots = [first.manifest.root_body]
    for number, (bundle, y_m) in enumerate(zip(bundles[1:], places_m[1:], strict=True), start=1):
        infant = mujoco.MjSpec.from_string(_text(bundle, "infant.xml"), assets=_assets(bundle, number))
        _dress(infant, bundle, number)
        infant.option.integrator, infant.option.timestep = row.option.integrator, row.option.timestep
        prefix = f"infant {number}{SEPARATOR}"
        row.attach(infant, frame=row.worldbody.add_frame(pos=[0, y_m, 0]), prefix=prefix)
        roots.append(prefix + bundle.manifest.root_body)
    row.visual.map.shadowclip = max(row.visual.map.shadowclip, places_m[-1] / 2 + BESIDE_M)
    return row.compile(), roots


def _dress(infant: mujoco.MjSpec, bundle: Bundle, number: int) -> None:
    """Show an infant that stands alone as it is in its scene: with its skin, if it has one there."""
    scene = mujoco.MjSpec.from_string(_text(bundle, bundle.manifest.scene), include=dict(bundle.files))
    for skin in scene.skins:
        own = {"file": _own_file(skin.file, number), "material": skin.material, "group": skin.group}
        infant.add_skin(name=skin.name, **own)
    for geom in infant.geoms:
        geom.group = scene.geom(geom.name).group


def _text(bundle: Bundle, name: str) -> str:
    return bundle.files[name].decode()


def _assets(bundle: Bundle, number: int = 0) -> dict[str, bytes]:
    """Return the files that a bundle's model refers to; its skins are its own."""
    files = {name: content for name, content in bundle.files.items() if name.startswith("assets/")}
    return {_own_file(name, number) if name.endswith(SKIN) else name: content for name, content in files.items()}


def _own_file(name: str, number: int) -> str:
    return f"{name.removesuffix(SKIN)}{number or ''}{SKIN}"
