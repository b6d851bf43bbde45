"""Soft light for pictures: a large sun, the sky and the floor's own light, drawn as the mean of several passes.

MuJoCo draws lights as points, so that shadows have hard edges, and each has one map of shadows, whose cells show as
speckle. Here a picture is the mean of `passes` drawings of one scene, `I = sum(I_k) / passes`. In each, every light
that casts shadows stands at other points of a disc, which softens shadows as a lamp of that size does, and the camera
is moved by another fraction of a pixel, which smooths all edges. As the mean smooths anyway, a pass needs neither
multisampling nor a fine map of shadows: eight passes take no longer than one in full quality did. The points are the
same for every picture, so that videos do not flicker.
"""

from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.base.geometry.rotations import FloatArray, direction
from mimoc.render.camera import Shot
from mimoc.render.renderer import Picture

Colour = tuple[float, float, float]  # Red, green and blue, 0 to 1.
GOLDEN_RAD = float(np.pi * (3 - np.sqrt(5)))  # Angle between one point of a Fibonacci disc and the next.
FROM_ABOVE_DEG = -42.0  # Elevation of a view below which it is one from above.
DIRECTIONAL = mujoco.mjtLightType.mjLIGHT_DIRECTIONAL
FULL_DISC = 12
"""How many points fill the sun's disc; fewer are on a part of it, as near to each other, which shows no steps."""
STRENGTHS = ("diffuse", "ambient", "specular")
ACROSS = (0.6, 0.8, 0.0)  # A direction that no light shines along.
BLACK: Colour = (0.0, 0.0, 0.0)


@dataclass(frozen=True, slots=True)
class Exposure:
    """How many drawings a picture is the mean of."""

    passes: int
    suns: int = 1  # Points of the sun's disc that shine in each of them; a lamp in a room has one.
    shadows_px: int = 768  # Side of the map of the sun's shadows, whose cells the passes blur.


STILL, MOVING, ONCE = Exposure(4, 3), Exposure(4, 1, 256), Exposure(1)
"""Exposures of single pictures, of those of videos, and of the fastest ones, with hard shadows."""
ROW = Exposure(4, 2)  # Exposure of pictures of several infants, which have more triangles.


@dataclass(frozen=True, slots=True)
class Beam:
    """Light from one direction, without an end."""

    azimuth_deg: float  # Azimuth that it shines in, less the camera's: 0 is from behind the camera, 90 from its right.
    elevation_deg: float  # Elevation that it shines in; below 0 is downwards.
    colour: Colour  # Its light on what faces it.

    def towards(self, azimuth_deg: float) -> FloatArray:
        """Return the unit vector that it shines along, shape (3,), in the world, of a camera at an azimuth."""
        azimuth = float(np.radians(azimuth_deg + self.azimuth_deg))
        return direction(azimuth, float(np.radians(self.elevation_deg)))


@dataclass(frozen=True, slots=True)
class Daylight:
    """The light of a picture of an infant that is in no room."""

    sun: Beam  # The only one that casts shadows.
    sun_radius_deg: float  # Radius of its disc, as seen from the infant: as large as a window.
    fills: tuple[Beam, ...]  # Sky and floor, without shadows.
    ambient: Colour  # Light on everything.
    turned_deg: float
    """How far the sun is farther to the right in views from above, in which it would shine from under a chin."""


DAYLIGHT = Daylight(
    sun=Beam(36.0, -48.0, (0.41, 0.395, 0.37)),
    sun_radius_deg=7.0,
    fills=(
        Beam(-60.0, -72.0, (0.115, 0.125, 0.14)),
        Beam(5.0, -5.0, (0.155, 0.153, 0.151)),
        Beam(0.0, 60.0, (0.13, 0.118, 0.10)),
    ),
    ambient=(0.43, 0.425, 0.425),
    turned_deg=66.0,
)
"""A sun at the upper right of the camera, the sky above, light from beside the camera, and warm light that the floor
reflects (D)."""

GLOSS: Colour = (0.08, 0.08, 0.08)  # Gloss that the sun gives to what is shiny (D).
LAMP_RADIUS = 0.08  # Radius of a lamp in a room, as a share of its distance from the infant (D).
SUN_DISTANCE_M = 4.0  # Distance from the middle of what is shown to where the map of shadows begins.
NEAR = 0.25  # Where the picture begins, as a share of the distance of what is shown.
FAR_M = 10000.0
"""Where the picture ends. MuJoCo raises shadows by a share of it; if that is too little, surfaces that face the sun are
speckled with their own shadow: they are with an end at 60 m, and are not with one at 10 km."""
SHADOWS_WITHIN = 1.1
"""Radius around the middle of what is shown within which things cast shadows, in radii of what is shown."""
SHADOWS_FROM = 2.5
"""The same radius where a picture shows less, in halves of its height: shadows of things that are farther away do not
fall into it."""
ROUND_OFF = 1e-9  # Lets halves be rounded up, whatever the last bit of a division is.


def disc_points(count: int) -> FloatArray:
    """Return points that are spread evenly over the unit disc, shape (count, 2).

    They are those of a Fibonacci disc, `r_i = sqrt((i + 1/2) / count)` at the angle `i * GOLDEN_RAD`.

    >>> bool(abs(disc_points(16).mean(axis=0)).max() < 0.05)
    True
    """
    steps = np.arange(count)
    radii = np.sqrt((steps + 0.5) / count)
    angles = steps * GOLDEN_RAD
    return np.stack([radii * np.cos(angles), radii * np.sin(angles)], axis=1)


def pixel_points(count: int) -> FloatArray:
    """Return points that are spread evenly over a pixel, from -1/2 to 1/2, shape (count, 2).

    No two share a row or a column: along one side they are `(i + 1/2) / count`, along the other they are the multiples
    of the golden section, put in order.
    """
    along = (np.arange(count) + 0.5) / count
    order = np.argsort(np.argsort(np.arange(count) * (np.sqrt(5) - 1) / 2 % 1.0))
    return np.stack([along, along[order]], axis=1) - 0.5


def passes(
    scene: mujoco.MjvScene, shot: Shot, height_px: int, exposure: Exposure, daylight: Daylight | None = None
) -> Iterator[None]:
    """Light a scene that is filled, for each pass of a picture of a shot in turn.

    With daylight, its lights replace those of the scene.
    """
    if daylight is not None:
        _set_daylight(scene, shot, daylight)
        _keep_floor_from_casting(scene)
        for camera in scene.camera:
            _set_range(camera, NEAR * shot.depth_m, FAR_M)
    steady, casting = _sorted_lights(scene)
    cameras = [(camera, camera.frustum_center, camera.frustum_bottom, camera.frustum_top) for camera in scene.camera]
    suns = exposure.suns if daylight is not None else 1
    lamp_points = disc_points(exposure.passes * suns).reshape(suns, exposure.passes, 2)
    radius = np.tan(np.radians(daylight.sun_radius_deg)) if daylight is not None else LAMP_RADIUS
    radius *= min(1.0, np.sqrt(exposure.passes * suns / FULL_DISC))
    for number, point in enumerate(pixel_points(exposure.passes)):
        for camera, centre, bottom, top in cameras:
            across, up = point * (top - bottom) / height_px
            camera.frustum_center = centre + across
            camera.frustum_bottom = bottom + up
            camera.frustum_top = top + up
        scene.nlight = steady
        for light in casting:
            for lamp_point in lamp_points[:, number]:
                _add_light(scene, light, 1 / suns)
                _move_light(scene.lights[scene.nlight - 1], shot, radius * lamp_point)
        yield


def _set_daylight(scene: mujoco.MjvScene, shot: Shot, daylight: Daylight) -> None:
    azimuth, elevation = shot.view
    scene.nlight = 1 + len(daylight.fills)
    for light, beam in zip(scene.lights, (daylight.sun, *daylight.fills), strict=False):
        light.type = DIRECTIONAL
        light.headlight = 0
        light.castshadow = beam is daylight.sun
        light.texid = -1
        turned_deg = daylight.turned_deg if beam is daylight.sun and elevation < FROM_ABOVE_DEG else 0.0
        light.dir[:] = beam.towards(azimuth + turned_deg)
        light.pos[:] = shot.lookat_m - SUN_DISTANCE_M * light.dir
        light.diffuse[:] = beam.colour
        # The ambient light counts once, with the first fill.
        light.ambient[:] = daylight.ambient if beam is daylight.fills[0] else BLACK
        light.specular[:] = GLOSS if beam is daylight.sun else BLACK


def _keep_floor_from_casting(scene: mujoco.MjvScene) -> None:
    """Take planes out of the map of shadows, in which the seams of their large triangles show as lines.

    MuJoCo draws there whatever is no decoration.
    """
    for geom in scene.geoms[: scene.ngeom]:
        if geom.type == mujoco.mjtGeom.mjGEOM_PLANE:
            geom.category = mujoco.mjtCatBit.mjCAT_DECOR


def _set_range(camera: mujoco.MjvGLCamera, near_m: float, far_m: float) -> None:
    """Let a camera see things within a range of distances, in the same field of view."""
    ratio = near_m / camera.frustum_near
    camera.frustum_near = near_m
    camera.frustum_far = far_m
    camera.frustum_center *= ratio
    camera.frustum_bottom *= ratio
    camera.frustum_top *= ratio


_Light = dict[str, Any]  # The values of a light of MuJoCo, by the name of the field.


def _sorted_lights(scene: mujoco.MjvScene) -> tuple[int, list[_Light]]:
    """Put the lights that cast no shadows first; return how many they are, and the others."""
    lights = [
        {name: copy(getattr(light, name)) for name in dir(light) if not name.startswith("_")}
        for light in scene.lights[: scene.nlight]
    ]
    steady = [light for light in lights if not light["castshadow"]]
    scene.nlight = 0
    for light in steady:
        _add_light(scene, light)
    return len(steady), [light for light in lights if light["castshadow"]]


def _add_light(scene: mujoco.MjvScene, values: _Light, share: float = 1.0) -> None:
    light = scene.lights[scene.nlight]
    for name, value in values.items():
        setattr(light, name, share * value if name in STRENGTHS else value)
    scene.nlight += 1


def _move_light(light: mujoco.MjvLight, shot: Shot, point: FloatArray) -> None:
    """Move a light to a point of its disc, shape (2,), in units of its distance from the middle of a shot."""
    directional = light.type == DIRECTIONAL
    ahead = light.dir if directional else shot.lookat_m - light.pos
    distance_m = SUN_DISTANCE_M if directional else float(np.linalg.norm(ahead))
    ahead = ahead / np.linalg.norm(ahead)
    side = np.cross(ahead, ACROSS)
    side /= np.linalg.norm(side)
    shift = point @ np.array([side, np.cross(ahead, side)])
    if directional:
        light.dir[:] = (ahead + shift) / np.linalg.norm(ahead + shift)
        light.pos[:] = shot.lookat_m - distance_m * light.dir
    else:
        light.pos[:] += distance_m * shift


LIFT = 0.35  # How much brighter pictures in daylight are between dark and white than what the lights give (D).


def toned(share: FloatArray) -> FloatArray:
    """Return brightness in pictures in daylight, `x + LIFT x^2 (1 - x)`, of what the lights give, 0 to 1."""
    return share + LIFT * share**2 * (1 - share)


class Mean:
    """The mean of the pictures of all passes, the same on every machine."""

    def __init__(self, daylight: bool = False):
        """Begin with no picture; those in daylight are brightened in the end, see `toned`."""
        self._passes = 0
        self._sum = np.zeros(1, np.uint16)
        self._daylight = daylight
        self._opaque: npt.NDArray[np.uint16] | None = None

    def add(self, drawn: Picture, opaque: npt.NDArray[np.bool_] | None = None) -> None:
        """Add a picture, shape (height, width, 3), of which only a part may count, shape (height, width)."""
        counted = drawn if opaque is None else drawn * opaque[..., None]
        if not self._passes:
            self._sum = counted.astype(np.uint16)
            self._opaque = opaque if opaque is None else opaque[..., None].astype(np.uint16)
        else:
            self._sum += counted
            if self._opaque is not None and opaque is not None:
                self._opaque += opaque[..., None]
        self._passes += 1

    def picture(self) -> Picture:
        """Return the mean, rounded, with the opacity as a fourth colour if only parts counted."""
        if self._opaque is None:
            return self._bytes(self._passes)[self._sum]
        colours = (self._sum + self._opaque // 2) // np.maximum(self._opaque, 1)
        opacity = (255 * self._opaque + self._passes // 2) // self._passes
        return np.concatenate([self._bytes(1)[colours], opacity.astype(np.uint8)], axis=2)

    def _bytes(self, passes: int) -> npt.NDArray[np.uint8]:
        """Return the byte of the picture for each sum over a number of passes, shape (255 passes + 1,)."""
        share = np.arange(255 * passes + 1) / (255 * passes)
        return np.floor(255 * (toned(share) if self._daylight else share) + 0.5 + ROUND_OFF).astype(np.uint8)
