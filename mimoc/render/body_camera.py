"""A camera that keeps one infant or several in the picture."""

from collections.abc import Sequence
from functools import partial

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.manifest import CaregiverEntry, Manifest
from mimoc.bundle.world import WorldManifest
from mimoc.render.camera import (
    FOVY_DEG,
    FROM_THE_SIDE,
    MARGIN,
    Shot,
    Spheres,
    View,
    bounding_spheres,
    fit_shot,
    planes_of,
    unobstructed_view,
    view_of_bodies,
)
from mimoc.render.markers import Markers, add_markers
from mimoc.render.renderer import Picture, Renderer, Setting, Shown, average_down, visual_settings

STILL, MOVING = 3, 2
"""Supersampling of single pictures and of moving ones: they are drawn so many times larger and then averaged down,
which smooths the edges of shadows too."""
LARGEST_PX = 4096
"""Side of what is drawn: a picture that would be larger is drawn at its size, with MuJoCo's multisampling."""
SAMPLES = 8
"""For each pixel, of MuJoCo's multisampling."""
BACKDROP = (0.915, 0.94, 0.935, 1.0)
"""What the floor fades into behind an infant that is in no room: the colour of the sky above it."""
SHADOWS_WITHIN_M = 1.0
"""Distance from an infant that is drawn alone within which things cast shadows: half of the usual, so that the edges of
shadows are twice as fine. With a quarter, the floor gets speckled."""
HIDDEN_GROUP = 5
"""MuJoCo's group of geoms that are not drawn by default, and that mimoc has none in."""
FADES_BEHIND_M, FADES_WITHIN_M = 0.7, 4.5
"""How far behind the middle of a picture it begins to, and the distance that it takes."""


NEAR_M, STRING_M = 1.0, 0.15
"""Distance from an infant within which its objects are in its pictures, but for what is longer, such as strings."""


def company(manifest: Manifest | WorldManifest, roots: Sequence[str], data: mujoco.MjData) -> list[str]:
    """Return the outermost bodies in pictures of infants besides theirs: objects near them, and who is with them."""
    places_m = np.array([data.body(root).xpos for root in roots])
    middles_m = {item.body: data.body(item.body).subtree_com for item in manifest.objects}
    near = [name for name, at in middles_m.items() if (np.linalg.norm(places_m - at, axis=1) < NEAR_M).any()]
    adult = _adult(manifest)
    return [*near, adult.head, *(body for arm in adult.arms for body in arm.bodies)] if adult else near


def view_of_scene(view: View, manifest: Manifest | WorldManifest, roots: Sequence[str], data: mujoco.MjData) -> View:
    """Return a view of infants, see `view_of_bodies`; with an adult by them, across the line between both."""
    if (adult := _adult(manifest)) is None:
        return view_of_bodies(view, data, roots)
    return view_of_bodies(view, data, [*roots, adult.trunk])[0], view[1]


def _adult(manifest: Manifest | WorldManifest) -> CaregiverEntry | None:
    return manifest.caregiver if isinstance(manifest, Manifest) else None


def backdrop_m(
    model: mujoco.MjModel, data: mujoco.MjData, roots: Sequence[str], view: View, aspect: float, fovy_deg: float
) -> float | None:
    """Return how far from a camera that looks at some bodies things may fade; None if a room is around them."""
    walls = planes_of(model, data)
    seen = np.isin(model.body_rootid[model.geom_bodyid], [model.body(root).id for root in roots])
    if len(walls.normals) > 1:
        return None
    return fit_shot(bounding_spheres(model, data, seen), walls, view, aspect, fovy_deg).depth_m + FADES_BEHIND_M


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
        supersample: int = MOVING,
        margin: float = MARGIN,
        shown: Shown = "skin",
        fade_m: float | None = None,
        cut_out: bool = False,
        beside: Sequence[str] = (),
    ):
        """Open an OpenGL context for pictures of this size.

        Args:
            model: The model.
            root_bodies: Names of the bodies.
            width_px: Of a picture.
            height_px: Of a picture.
            view: The direction it looks in.
            fovy_deg: Vertical field of view, where there is space for it.
            supersample: How many times larger pictures are drawn and then averaged down, if that is not too large.
            margin: How much wider the field of view is than what it has to show.
            shown: What is drawn of infants.
            fade_m: How far from the camera things begin to fade into a backdrop; by default, they do not.
            cut_out: Whether pictures show nothing else, on a transparent background; changes the model.
            beside: Names of other outermost bodies, that are to be in the picture as well.

        Raises:
            RenderingError: If there is no OpenGL here, or none that draws such large pictures.
        """
        self._model, self.view, self._fovy_deg, self._margin = model, view, fovy_deg, margin
        self._supersample = supersample if supersample * max(width_px, height_px) <= LARGEST_PX else 1
        self._seen = np.isin(model.body_rootid[model.geom_bodyid], [model.body(root).id for root in root_bodies])
        self.aspect = width_px / height_px
        """Width of the pictures over their height."""
        larger = self._supersample * width_px, self._supersample * height_px
        self._fades, self._cut_out = fade_m is not None, cut_out
        if cut_out:  # What is beside them is not drawn then.
            model.geom_group[~self._seen] = HIDDEN_GROUP
        else:
            are_beside = np.isin(model.body_rootid[model.geom_bodyid], [model.body(name).id for name in beside])
            self._seen |= are_beside & (model.geom_rbound < STRING_M)
        settings = partial(_settings, 0 if self._supersample > 1 else SAMPLES, fade_m, len(root_bodies) == 1)
        self._renderer = Renderer(model, *larger, settings, shown)

    def use_model(self, model: mujoco.MjModel) -> None:
        """Draw another model of the same parts from now on.

        Raises:
            RenderingError: If OpenGL has no room for it.
        """
        self._model = model
        self._renderer.change_model(model)

    def spheres(self, data: mujoco.MjData) -> Spheres:
        """Return what it looks at."""
        return bounding_spheres(self._model, data, self._seen)

    def turn(self, data: mujoco.MjData) -> None:
        """Look from now on from where the walls leave space."""
        walls = planes_of(self._model, data)
        self.view = unobstructed_view(self.spheres(data), walls, self.view, self.aspect, self._fovy_deg)

    def shot(self, data: mujoco.MjData) -> Shot:
        """Return the shot that shows all of it."""
        walls = planes_of(self._model, data)
        return fit_shot(self.spheres(data), walls, self.view, self.aspect, self._fovy_deg, self._margin)

    def render(self, data: mujoco.MjData, markers: Markers | None = None, shot: Shot | None = None) -> Picture:
        """Return a picture of all of it or of a shot; markers are drawn without shadows.

        Its shape is (height, width, 3), or (height, width, 4) with the opacity if all else is cut out.
        """
        with self._renderer.in_use():
            drawn = self._draw(data, markers, shot or self.shot(data))
            if self._cut_out:
                return _with_opacity(drawn, self._renderer.read_drawn()[::-1], self._supersample)
        if self._supersample == 1:
            return drawn.copy()
        return np.rint(average_down(drawn.astype(np.float32), self._supersample)).astype(np.uint8)

    def _draw(self, data: mujoco.MjData, markers: Markers | None, shot: Shot) -> Picture:
        renderer = self._renderer
        if markers is not None:
            renderer.reserve(len(markers.radii_m))
        self._compose(data, shot)
        flags, shadow = renderer.scene.flags, mujoco.mjtRndFlag.mjRND_SHADOW
        shadows = flags[shadow]
        if markers is not None:
            flags[shadow] = False  # Those of the markers would hide the skin.
            add_markers(renderer.scene, markers)
        renderer.draw()
        flags[shadow] = shadows
        return renderer.read()[::-1]

    def close(self) -> None:
        """Free the OpenGL context; closing twice is fine."""
        self._renderer.close()

    def _compose(self, data: mujoco.MjData, shot: Shot) -> None:
        """Fill the scene with what a shot shows."""
        camera = mujoco.MjvCamera()
        camera.lookat[:], camera.distance = shot.lookat_m, shot.depth_m
        camera.azimuth, camera.elevation = shot.view
        with visual_settings([(self._model.vis.global_, "fovy", shot.fovy_deg)]):
            self._renderer.compose(data, camera)
        scene = self._renderer.scene
        scene.flags[mujoco.mjtRndFlag.mjRND_FOG] = self._fades
        if self._cut_out:
            scene.flags[mujoco.mjtRndFlag.mjRND_SKYBOX] = False
        for light in scene.lights[: scene.nlight]:
            if light.type == mujoco.mjtLightType.mjLIGHT_DIRECTIONAL and not light.headlight:
                light.pos[:2] += shot.lookat_m[:2]  # The sun is everywhere; the shadows it draws are around a point.


def _with_opacity(drawn: Picture, is_drawn: npt.NDArray[np.bool_], times: int) -> Picture:
    """Return a picture that is smaller so many times, with its opacity; colours are those of what is drawn alone."""
    opaque = is_drawn[..., None].astype(np.float32)
    share = average_down(opaque, times)
    colour = average_down(drawn * opaque, times) / np.maximum(share, np.finfo(np.float32).tiny)
    return np.rint(np.concatenate([colour, 255 * share], axis=2)).astype(np.uint8)


def _settings(samples: int, fade_m: float | None, alone: bool, model: mujoco.MjModel) -> list[Setting]:
    settings: list[Setting] = [(model.vis.quality, "offsamples", samples)]
    if fade_m is not None:
        fog, unit_m = model.vis.map, model.stat.extent
        settings += [(fog, "shadowclip", SHADOWS_WITHIN_M / unit_m)] if alone else []
        settings += [(fog, "fogstart", fade_m / unit_m), (fog, "fogend", (fade_m + FADES_WITHIN_M) / unit_m)]
        settings.append((model.vis.rgba, "fog", BACKDROP))
    return settings
