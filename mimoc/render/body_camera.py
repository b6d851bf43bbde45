"""A camera that keeps one infant or several in the picture."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial

import mujoco
import numpy as np
import numpy.typing as npt
from PIL import Image

from mimoc.base.geometry.rotations import FloatArray
from mimoc.base.mujoco_layout import SOLIDS_GROUP
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.world import WorldManifest
from mimoc.render.camera import (
    FOVY_DEG,
    FROM_THE_SIDE,
    MARGIN,
    Shot,
    Spheres,
    View,
    bounding_spheres,
    drawn_spheres,
    fit_shot,
    planes_of,
    unobstructed_view,
    view_of_bodies,
)
from mimoc.render.opengl import set_fog
from mimoc.render.renderer import Picture, Renderer, Setting, Shown, visual_settings
from mimoc.render.soft_light import DAYLIGHT, MOVING, SHADOWS_FROM, SHADOWS_WITHIN, Colour, Exposure, Mean, passes

CROWD_M, CROWD_PX = 1.0, 1024
"""Radius within which other things cast shadows, too, and the side of the map of shadows then, or of those of a lamp in
a room."""
DRAWN_GROUPS = 3  # How many of MuJoCo's groups of geoms are drawn by default.
HIDDEN_GROUP = 3  # MuJoCo's group of geoms that are never drawn, and that mimoc has none in.
NEAR_M, STRING_M = 1.0, 0.15
"""Distance from an infant within which its objects are in its pictures, but for what is longer, such as strings."""


def company(manifest: Manifest | WorldManifest, roots: Sequence[str], data: mujoco.MjData) -> list[str]:
    """Return the outermost bodies in pictures of infants besides theirs: objects near them, and who is with them."""
    places_m = np.array([data.body(root).xpos for root in roots])
    middles_m = {item.body: data.body(item.body).subtree_com for item in manifest.objects}
    near = [name for name, at in middles_m.items() if (np.linalg.norm(places_m - at, axis=1) < NEAR_M).any()]
    adult = manifest.caregiver
    return [*near, adult.head, *(body for arm in adult.arms for body in arm.bodies)] if adult else near


def view_of_scene(view: View, manifest: Manifest | WorldManifest, roots: Sequence[str], data: mujoco.MjData) -> View:
    """Return a view of infants, see `view_of_bodies`; with an adult by them, across the line between both."""
    if (adult := manifest.caregiver) is None:
        return view_of_bodies(view, data, roots)
    return view_of_bodies(view, data, [*roots, adult.trunk])[0], view[1]


@dataclass(frozen=True, slots=True)
class Markers:
    """Some n spheres to draw."""

    positions_m: FloatArray  # Shape (n, 3), in the world.
    radii_m: FloatArray  # Shape (n,).
    colours: npt.NDArray[np.float32]  # Red, green, blue and opacity, shape (n, 4).

    def moved(self, move: Callable[[FloatArray], FloatArray]) -> "Markers":
        """Return them where a motion of points, shape (n, 3), takes them."""
        return Markers(move(self.positions_m), self.radii_m, self.colours)


class BodyCamera:
    """A camera that looks at some bodies and all that is attached to them, and the OpenGL context it needs."""

    def __init__(
        self,
        model: mujoco.MjModel,
        root_bodies: Sequence[str],
        width_px: int,
        height_px: int,
        view: View = FROM_THE_SIDE,
        *,
        fovy_deg: float = FOVY_DEG,
        exposure: Exposure = MOVING,
        margin: float = MARGIN,
        shown: Shown = "skin",
        cut_out: bool = False,
        beside: Sequence[str] = (),
        static_materials: bool = False,
    ):
        """Open an OpenGL context for pictures of this size, or raise a RenderingError.

        A picture is the mean of *exposure* drawings; the field of view is wider than what it shows by *margin*.
        *cut_out* shows nothing else, on a transparent background, and changes the model. *beside* are other outermost
        bodies in the picture. *static_materials* says that nothing gets another material later, as a face does with
        another expression: to open takes a third of the time then.
        """
        self._model, self.view, self._fovy_deg, self._margin = model, view, fovy_deg, margin
        self._seen = np.isin(model.body_rootid[model.geom_bodyid], [model.body(root).id for root in root_bodies])
        self.aspect, self._height_px = width_px / height_px, height_px
        """Width of the pictures over their height."""
        self._shown: Shown = shown
        self._exposure = exposure
        self._cut_out = cut_out
        self._outdoors = is_outdoors(model)
        if cut_out:  # What is beside them is not drawn then.
            model.geom_group[~self._seen] = HIDDEN_GROUP
        else:
            are_beside = np.isin(model.body_rootid[model.geom_bodyid], [model.body(name).id for name in beside])
            self._seen |= are_beside & (model.geom_rbound < STRING_M)
        others = drawn_geoms(model, shown) & ~self._seen & (model.geom_type != mujoco.mjtGeom.mjGEOM_PLANE)
        self._crowd_m = CROWD_M if others.any() else 0.0
        shadows_px = CROWD_PX if others.any() or not self._outdoors else exposure.shadows_px
        self._renderer = Renderer(
            model, width_px, height_px, partial(_settings, shown, static_materials, shadows_px), shown
        )

    def use_model(self, model: mujoco.MjModel) -> None:
        """Draw another model of the same parts from now on; raise a RenderingError if OpenGL has no room for it."""
        self._model = model
        self._renderer.change_model(model)

    def spheres(self, data: mujoco.MjData) -> Spheres:
        """Return what it looks at."""
        return bounding_spheres(self._model, data, self._seen)

    def turn(self, data: mujoco.MjData) -> None:
        """Look from now on from where the walls leave space."""
        walls = planes_of(self._model, data)
        self.view = unobstructed_view(self.spheres(data), walls, self.view, self.aspect, self._fovy_deg)

    def shot(self, data: mujoco.MjData, spheres: Spheres | None = None) -> Shot:
        """Return the shot that shows all of it, or some spheres."""
        walls = planes_of(self._model, data)
        shown = spheres or self.spheres(data)
        return fit_shot(shown, walls, self.view, self.aspect, self._fovy_deg, self._margin)

    def drawn(self, data: mujoco.MjData, bodies: Sequence[str]) -> Spheres:
        """Return what is drawn of some bodies and all that hangs on them, more closely than `spheres` has it."""
        self._renderer.compose(data, mujoco.MjvCamera())
        are_drawn = drawn_geoms(self._model, self._shown)
        return drawn_spheres(self._model, data, self._renderer.scene, bodies, are_drawn, self._shown)

    def render(self, data: mujoco.MjData, markers: Markers | None = None, shot: Shot | None = None) -> Picture:
        """Return a picture of all of it or of a shot; markers are drawn without shadows.

        Its shape is (height, width, 3), or (height, width, 4) with the opacity if all else is cut out.
        """
        with self._renderer.in_use():
            return self._draw(data, markers, shot or self.shot(data))[::-1]

    def _draw(self, data: mujoco.MjData, markers: Markers | None, shot: Shot) -> Picture:
        renderer, exposure = self._renderer, self._exposure
        if markers is not None:
            renderer.reserve(len(markers.radii_m))
        self._compose(data, shot)
        scene, shadow = renderer.scene, mujoco.mjtRndFlag.mjRND_SHADOW
        shadows = scene.flags[shadow]
        if markers is not None:
            scene.flags[shadow] = False  # Those of the markers would hide the skin.
            add_markers(scene, markers)
        mean = Mean(self._outdoors)
        for _ in passes(scene, shot, self._height_px, exposure, DAYLIGHT if self._outdoors else None):
            renderer.draw()
            mean.add(renderer.read(), renderer.read_drawn() if self._cut_out else None)
        scene.flags[shadow] = shadows
        return mean.picture()

    def close(self) -> None:
        """Free the OpenGL context; closing twice is fine."""
        self._renderer.close()

    def _compose(self, data: mujoco.MjData, shot: Shot) -> None:
        camera = mujoco.MjvCamera()
        camera.lookat[:], camera.distance = shot.lookat_m, shot.depth_m
        camera.azimuth, camera.elevation = shot.view
        with visual_settings([(self._model.vis.global_, "fovy", shot.fovy_deg)]):
            self._renderer.compose(data, camera)
        leave_out_walls(self._renderer.scene, shot.position_m)
        flags = self._renderer.scene.flags
        flags[mujoco.mjtRndFlag.mjRND_FOG] = self._outdoors and not self._cut_out
        flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = not self._cut_out
        radius_m = self.spheres(data).radius_m(shot.lookat_m)
        if self._outdoors:
            fade(shot, radius_m)
        around_m = max(SHADOWS_WITHIN * min(radius_m, SHADOWS_FROM * shot.half_height_m), self._crowd_m)
        self._renderer.context.shadowClip = around_m


def _settings(shown: Shown, static_materials: bool, shadows_px: int, model: mujoco.MjModel) -> list[Setting]:
    outdoors, quality = is_outdoors(model), model.vis.quality
    shadows_px = min(quality.shadowsize, shadows_px)
    settings: list[Setting] = [(quality, "offsamples", 0), (quality, "shadowsize", shadows_px)]
    colours = model.tex_data
    if outdoors:
        colours = backdrop_colours(model)
        settings += [(model, "tex_data", colours), (model.vis.rgba, "fog", (*BACKGROUND, 1.0))]
    if static_materials:
        # One pixel of a plain sky is enough.
        materials = np.concatenate([model.geom_matid[drawn_geoms(model, shown)], model.skin_matid])
        used = np.isin(np.arange(model.ntex), model.mat_texid[materials[materials >= 0]])
        settings += lean_textures(
            model, colours, used | ((model.tex_type == mujoco.mjtTexture.mjTEXTURE_SKYBOX) & (not outdoors))
        )
    return settings


def drawn_geoms(model: mujoco.MjModel, shown: Shown) -> npt.NDArray[np.bool_]:
    """Return which geoms are drawn, shape (ngeom,)."""
    return (model.geom_group < DRAWN_GROUPS) | ((model.geom_group == SOLIDS_GROUP) & (shown == "solids"))


BACKGROUND: Colour = (0.937, 0.928, 0.914)
FLOOR: tuple[Colour, Colour] = (1.0, 0.992, 0.976), (0.984, 0.976, 0.96)
"""Colours of the fields of the floor, before light falls on it: two that hardly differ (D)."""
FADES_WITHIN = 1.6
"""Distance over which the floor fades behind what is shown, as a share of that from the camera to there (D)."""
SKY, MAT = "sky", "mat"  # Names of textures in `templates/scene.xml.j2`.


def is_outdoors(model: mujoco.MjModel) -> bool:
    """Return whether no room is around the infants of a model: it has at most one plane, the floor."""
    return int((model.geom_type == mujoco.mjtGeom.mjGEOM_PLANE).sum()) <= 1


def backdrop_colours(model: mujoco.MjModel) -> npt.NDArray[np.uint8]:
    """Return the colours of all textures of a model, as `tex_data` has them, floor and sky as in pictures."""
    colours = model.tex_data.copy()
    for name in (SKY, MAT):
        number = mujoco.mj_name2id(model, mujoco.mjtObj.mjOBJ_TEXTURE, name)
        if number >= 0:
            texture = model.texture(number)
            (start,), (width,), (height,), (channels,) = texture.adr, texture.width, texture.height, texture.nchannel
            pixels = colours[start : start + width * height * channels].reshape(-1, channels)
            pixels[:] = _of_byte(BACKGROUND) if name == SKY else _floor(pixels)
    return colours


def fade(shot: Shot, radius_m: float) -> None:
    """Let what is drawn from now on fade behind what is within a radius of the middle of a shot."""
    start_m = shot.depth_m + radius_m
    set_fog(start_m, (1 + FADES_WITHIN) * start_m)


def leave_out_walls(scene: mujoco.MjvScene, position_m: FloatArray) -> None:
    """Draw nothing of the planes of a scene that a camera is behind, whose position has the shape (3,).

    MuJoCo draws them over all that is in a room, with three tenths of their opacity: as a haze.
    """
    for geom in scene.geoms[: scene.ngeom]:
        if geom.type == mujoco.mjtGeom.mjGEOM_PLANE and (position_m - geom.pos) @ geom.mat[:, 2] < 0:
            geom.type = mujoco.mjtGeom.mjGEOM_NONE


def _floor(pixels: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    brightness = pixels.sum(axis=1, dtype=np.int64)
    return np.where((2 * brightness > brightness.min() + brightness.max())[:, None], *map(_of_byte, FLOOR))


def _of_byte(colour: Colour) -> npt.NDArray[np.uint8]:
    return np.rint(255 * np.array(colour)).astype(np.uint8)


CUBE_SIDES = 6
FLAT = mujoco.mjtTexture.mjTEXTURE_2D
Bytes = npt.NDArray[np.uint8]


def lean_textures(model: mujoco.MjModel, colours: Bytes, used: npt.NDArray[np.bool_]) -> list[Setting]:
    """Return smaller textures, while OpenGL takes them: a pixel of those not *used*, shape (ntex,)."""
    pictures = [_picture(model, colours, number, bool(used[number])) for number in range(model.ntex)]
    sizes = np.array([picture.size for picture in pictures])
    if sizes.sum() > colours.size:  # There is no room for more than the model has.
        return [(model, "tex_data", colours)]
    packed = np.zeros_like(colours)
    packed[: sizes.sum()] = np.concatenate([picture.ravel() for picture in pictures])
    heights, widths = np.array([picture.shape[:2] for picture in pictures], np.int32).T
    starts = (np.cumsum(sizes) - sizes).astype(model.tex_adr.dtype)
    changed = {"tex_data": packed, "tex_adr": starts, "tex_height": heights, "tex_width": widths}
    return [(model, name, values) for name, values in changed.items()]


def _picture(model: mujoco.MjModel, colours: Bytes, number: int, is_used: bool) -> Bytes:
    """Return the pixels of a texture with sides of 2^n, the faces of a cube one below the other."""
    height, width, start = model.tex_height[number], model.tex_width[number], model.tex_adr[number]
    channels = model.tex_nchannel[number]
    sides = 1 if model.tex_type[number] == FLAT else CUBE_SIDES
    faces = colours[start : start + height * width * channels].reshape(sides, height // sides, width, channels)
    if not is_used:
        faces = faces[:, :1, :1]
    return np.concatenate([_enlarged(face) for face in faces])


def _enlarged(face: Bytes) -> Bytes:
    """Return a picture with sides that are the next powers of two, its colours between those of its pixels."""
    height, width = (1 << (side - 1).bit_length() for side in face.shape[:2])
    if (height, width) == face.shape[:2]:
        return face
    return np.asarray(Image.fromarray(face).resize((width, height), Image.Resampling.BILINEAR))


RADIUS_IN_SPACINGS = 0.16  # Radius of a marker, as a share of the spacing of the skin.
MAX_RADIUS_M = 0.0025  # Or those of trunk and legs would hide what they are on.
ENLARGEMENT = 1.6  # How much larger the markers of points under force are.
UNLOADED = (0.05, 0.2, 0.75, 1.0)
LEAST_LOADED, MOST_LOADED = (1.0, 0.85, 0.1, 1.0), (0.85, 0.0, 0.1, 1.0)
"""Colours of points under no force, under the least and under the largest, as red, green, blue and opacity."""


def force_markers(positions_m: FloatArray, forces_n: FloatArray, spacings_m: FloatArray) -> Markers:
    """Return a marker for each of n points of a skin in the world, shape (n, 3), in the colour of the force on it.

    Magnitudes of forces, and distances of points from their neighbours, have the shape (n,).
    """
    radii_m = np.minimum(RADIUS_IN_SPACINGS * spacings_m, MAX_RADIUS_M)
    share = (forces_n / max(forces_n.max(), 1e-12))[:, None]  # The scale of colours ends with the largest force.
    colours = np.where(
        share > 0, np.array(LEAST_LOADED) + share * np.subtract(MOST_LOADED, LEAST_LOADED), UNLOADED
    ).astype(np.float32)
    return Markers(positions_m, np.where(forces_n > 0, ENLARGEMENT, 1) * radii_m, colours)


def join_markers(parts: Iterable[Markers]) -> Markers:
    """Return all markers of several."""
    columns = zip(*((part.positions_m, part.radii_m, part.colours) for part in parts), strict=True)
    return Markers(*map(np.concatenate, columns))


def add_markers(scene: mujoco.MjvScene, markers: Markers) -> None:
    """Add markers to a scene that has room for them."""
    upright = np.eye(3).ravel()
    for position, radius_m, colour in zip(markers.positions_m, markers.radii_m, markers.colours, strict=True):
        geom = scene.geoms[scene.ngeom]
        mujoco.mjv_initGeom(geom, mujoco.mjtGeom.mjGEOM_SPHERE, np.full(3, radius_m), position, upright, colour)
        scene.ngeom += 1
