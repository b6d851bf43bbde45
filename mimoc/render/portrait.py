"""Pictures of infants: one in a pose, or several that stand in a row."""

from collections.abc import Sequence
from contextlib import closing
from itertools import accumulate
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.io import Bundle
from mimoc.bundle.model import load_posed
from mimoc.bundle.strangers import check_files
from mimoc.render.body_camera import STILL, BodyCamera, backdrop_m
from mimoc.render.camera import FOVY_DEG, FROM_THE_FRONT, FROM_THE_SIDE, view_of_body
from mimoc.render.markers import Markers, join_markers
from mimoc.render.renderer import Picture, Shown
from mimoc.units import cm_to_m

ROW_FOVY_DEG = 10.0
"""For infants in a row: from so far away that those at the ends do not turn their faces."""
GAP_IN_LENGTHS = 0.5
"""Distance of infants in a row, as a share of their length."""
SKIN = ".skn"
"""Ending of the files of skins: infants in a row share textures, but no skins."""
BESIDE_M = 1.0
"""How far beyond the ends of a row things cast shadows."""


def portrait(
    bundle: Bundle,
    pose: str | None = None,
    width: int = 640,
    height: int = 480,
    markers: Markers | None = None,
    shown: Shown = "skin",
) -> Picture:
    """Return a picture of an infant in a pose, shape (height, width, 3).

    Args:
        bundle: The infant.
        pose: A keyframe; else the bundle's own.
        width: In pixels.
        height: In pixels.
        markers: What is drawn on top of it, such as the points of its skin.
        shown: Whether it is drawn with its skin, or its solids.

    Raises:
        UnknownNameError: If the bundle has no such pose.
        RenderingError: If there is no OpenGL here.
    """
    model, data = load_posed(bundle, pose)
    root = bundle.manifest.root_body
    view = view_of_body(FROM_THE_SIDE, data, root)
    fade_m = backdrop_m(model, data, [root], view, width / height, FOVY_DEG)
    options: Any = {"supersample": STILL, "shown": shown, "fade_m": fade_m}
    with closing(BodyCamera(model, [root], width, height, view, **options)) as camera:
        camera.turn(data)
        return camera.render(data, markers)


def lineup(
    bundles: Sequence[Bundle],
    width: int = 640,
    height: int = 480,
    markers: Sequence[Markers] | None = None,
    shown: Shown = "skin",
) -> Picture:
    """Return a picture of several infants that stand in a row, to scale, shape (height, width, 3).

    Args:
        bundles: The infants, from the left; all their joints are at zero.
        width: In pixels.
        height: In pixels.
        markers: What is drawn on top of each, where it would be if the infant were alone.
        shown: Whether they are drawn with their skins, or their solids.

    Raises:
        RenderingError: If there is no OpenGL here.
    """
    places_m = _places_m(bundles)
    model, roots = _in_a_row(bundles, places_m)
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    drawn = None
    if markers is not None:
        drawn = join_markers(each.moved(np.array((0.0, y_m, 0.0))) for each, y_m in zip(markers, places_m, strict=True))
    fade_m = backdrop_m(model, data, roots, FROM_THE_FRONT, width / height, ROW_FOVY_DEG)
    options: Any = {"fovy_deg": ROW_FOVY_DEG, "supersample": STILL, "shown": shown, "fade_m": fade_m}
    with closing(BodyCamera(model, roots, width, height, FROM_THE_FRONT, **options)) as camera:
        return camera.render(data, drawn)


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
        prefix = f"infant {number}: "
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
