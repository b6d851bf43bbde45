"""Frames of a video: the infant, followed by a camera, and beside it the views of its eyes."""

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from mimoc.errors import RenderingError
from mimoc.render.averaging import average_down
from mimoc.render.body_camera import BodyCamera
from mimoc.render.camera import FROM_THE_SIDE, Shot, Spheres, shows, view_of_body
from mimoc.render.renderer import Picture, Shown
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import Observation
from mimoc.senses.vision.eyes import Eyes

SHAPE = 4 / 3
"""Aspect ratio of the camera image."""
SPACE = 1.25
"""Margin of the field of view around the infant, so that limbs can move without moving the camera."""
CLOSER = 0.7
"""The camera moves closer when its distance would be reduced by this factor."""
FOLLOWING_S = 1.0
"""Time constant of the camera's motion."""
HURRY = 0.1
"""Step by which the camera's motion is sped up until the whole infant is in view."""
GAP_PX = 4
"""Gap between the images of a frame."""
BACKGROUND = 255
SHARP = 2
"""Factor of supersampling for the views of eyes that the infant does not observe."""


class Film:
    """Renders the frames of a video of one environment."""

    def __init__(self, env: InfantEnv, height_px: int, eyes: bool = False, shown: Shown = "skin"):
        """Open the cameras.

        Args:
            env: The environment.
            height_px: Height of a frame; the camera image is a third wider than high.
            eyes: Whether to show the views of the eyes: the observed images or, without vision, unblurred views.
            shown: Whether infants are drawn with their skins, or their solids.

        Raises:
            RenderingError: If OpenGL is not available, or the infant has no eyes.
        """
        self._env = env
        self._eyes = _eyes_of(env, _cell_px(height_px), shown) if eyes else None
        root = env.manifest.root_body
        view = view_of_body(FROM_THE_SIDE, env.data, root)
        size_px = round(SHAPE * height_px), height_px
        self._camera = BodyCamera(env.model, [root], *size_px, view, margin=SPACE, shown=shown)
        self._camera.turn(env.data)
        self.shot: Shot | None = None
        """Shot of the last frame."""
        self._goal = self._camera.shot(env.data)
        """Shot that the camera is moving to."""
        self._time_s = 0.0

    def frame(self, observation: Observation) -> Picture:
        """Return a frame of the current state, shape (height, width, 3).

        Args:
            observation: The current observation.
        """
        self.shot = self._followed()
        self._time_s = self._env.data.time
        outside = self._camera.render(self._env.data, shot=self.shot)
        return outside if self._eyes is None else _beside(outside, self._eyes.pictures(self._env.data, observation))

    @property
    def spheres(self) -> Spheres:
        """What is to be in the picture now."""
        return self._camera.spheres(self._env.data)

    @property
    def aspect(self) -> float:
        """Width over height of the picture from outside."""
        return self._camera.aspect

    def close(self) -> None:
        """Free the OpenGL contexts; closing twice is fine."""
        self._camera.close()
        if self._eyes is not None:
            self._eyes.close()

    def _followed(self) -> Shot:
        """Return the next shot: the previous one, unless the infant leaves it or becomes small in it."""
        data, aspect = self._env.data, self.aspect
        spheres, wanted, passed_s = self.spheres, self._camera.shot(data), data.time - self._time_s
        if self.shot is None or passed_s < 0:  # A new episode: cut.
            self._goal = wanted
            return wanted
        if not shows(self._goal, spheres, aspect) or wanted.depth_m < CLOSER * self._goal.depth_m:
            self._goal = wanted
        share = 1 - math.exp(-passed_s / FOLLOWING_S)
        while not shows(shot := _between(self.shot, self._goal, share), spheres, aspect) and share < 1:
            share = min(1.0, share + HURRY)
        return shot


class _Observed:
    """The images in the observation, with the infant's acuity, foveation and delay."""

    def __init__(self, cameras: Sequence[str]):
        self._cameras = cameras

    def pictures(self, data: mujoco.MjData, observation: Observation) -> list[Picture]:
        return [observation[camera] for camera in self._cameras]

    def close(self) -> None:
        """Do nothing: there is nothing to free."""


class _Sharp:
    """Unblurred views of the eyes of an infant without vision."""

    def __init__(self, model: mujoco.MjModel, cameras: Sequence[str], size_px: int, shown: Shown):
        bodies = model.cam_bodyid[[model.camera(camera).id for camera in cameras]]
        own = {model.body(index).name for body in bodies for index in (body, model.body_parentid[body])}
        self._eyes = Eyes(model, cameras, SHARP * size_px, SHARP * size_px, own, shown)

    def pictures(self, data: mujoco.MjData, observation: Observation) -> list[Picture]:
        return list(np.rint(average_down(self._eyes(data).astype(np.float32), SHARP)).astype(np.uint8))

    def close(self) -> None:
        self._eyes.close()


def _eyes_of(env: InfantEnv, size_px: int, shown: Shown) -> _Observed | _Sharp:
    """Return the source of the eyes' views; *size_px* is the size of views that are not observed."""
    vision = env.manifest.senses.vision
    if vision is not None:
        return _Observed(vision.cameras)
    cameras = [eye.camera for eye in env.manifest.anatomy.eyes]
    if not cameras:
        raise RenderingError(f"'{env.manifest.name}' has no eyes; record it without their views")
    return _Sharp(env.model, cameras, size_px, shown)


def _between(one: Shot, other: Shot, share: float) -> Shot:
    """Return the linear interpolation between two shots, with the view direction of the second."""
    return Shot(
        one.position_m + share * (other.position_m - one.position_m),
        one.depth_m + share * (other.depth_m - one.depth_m),
        other.view,
        one.fovy_deg + share * (other.fovy_deg - one.fovy_deg),
    )


def _beside(outside: Picture, seen: Sequence[Picture]) -> Picture:
    """Return a frame with a column of further images on the right, scaled to fit with square pixels."""
    height = outside.shape[0]
    cell_px = _cell_px(height)
    fitted = [_fitted(picture, cell_px) for picture in seen]
    column = np.full((height, GAP_PX + max(picture.shape[1] for picture in fitted), 3), BACKGROUND, np.uint8)
    for number, picture in enumerate(fitted):
        top = number * (height - cell_px)
        column[top : top + cell_px, GAP_PX : GAP_PX + picture.shape[1]] = picture
    return np.concatenate([outside, column], axis=1)


def _cell_px(height_px: int) -> int:
    """Return the height of an eye's view in a frame; the two are stacked."""
    return (height_px - GAP_PX) // 2


def _fitted(picture: Picture, height_px: int) -> Picture:
    """Return an image scaled to another height: averaged down if much larger, then by nearest neighbour."""
    times = max(1, min(picture.shape[0] // height_px, picture.shape[1]))
    rows, columns = (side // times * times for side in picture.shape[:2])
    smaller = np.rint(average_down(picture[:rows, :columns].astype(np.float32), times)).astype(np.uint8)
    height, width = smaller.shape[:2]
    width_px = max(1, round(width * height_px / height))
    return smaller[np.arange(height_px) * height // height_px][:, np.arange(width_px) * width // width_px]
