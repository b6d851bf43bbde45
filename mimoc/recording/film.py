"""Frames of a film: an infant from outside, kept in the picture, and beside it what its eyes see."""

import math
from collections.abc import Sequence

import mujoco
import numpy as np

from mimoc.errors import RenderingError
from mimoc.render.averaging import average_down
from mimoc.render.body_camera import BodyCamera
from mimoc.render.camera import FROM_THE_SIDE, Shot, Spheres, shows, view_of_body
from mimoc.render.renderer import Picture
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import Observation
from mimoc.senses.vision.eyes import Eyes

SHAPE = 4 / 3
"""Width over height of the picture from outside."""
SPACE = 1.25
"""How much wider the field of view is than what it has to show, so that limbs can move without the camera."""
CLOSER = 0.7
"""It goes nearer when it would be this much nearer then."""
FOLLOWING_S = 1.0
"""Time in which the camera goes most of the way to where it should be."""
HURRY = 0.1
"""How much more of the way it goes at a time, until all of the infant is in the picture."""
GAP_PX = 4
"""Between the pictures of a frame."""
PAPER = 255
EYES = ("eye_left", "eye_right")
SHARP = 2
"""How many times larger the view of eyes that the infant does not use is drawn, and then averaged down."""


class Film:
    """Draws the frames of a film of one environment."""

    def __init__(self, env: InfantEnv, height_px: int, eyes: bool = False):
        """Open the cameras.

        Args:
            env: The infant.
            height_px: Of a frame; the picture from outside is a third wider than high.
            eyes: Whether to show what the eyes see: what the infant observes, or, if it has no vision, what it would
                see with eyes of full acuity.

        Raises:
            RenderingError: If there is no OpenGL here, or the infant has no eyes to show.
        """
        self._env = env
        self._eyes = _eyes_of(env, _cell_px(height_px)) if eyes else None
        root = env.manifest.root_body
        view = view_of_body(FROM_THE_SIDE, env.data, root)
        self._camera = BodyCamera(env.model, [root], round(SHAPE * height_px), height_px, view, margin=SPACE)
        self._camera.turn(env.data)
        self.shot: Shot | None = None
        """Of the last frame."""
        self._goal = self._camera.shot(env.data)
        """Where the camera is going."""
        self._time_s = 0.0

    def frame(self, observation: Observation) -> Picture:
        """Return the next frame, shape (height, width, 3), of the environment as it is now.

        Args:
            observation: What the infant observes now.
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
        """Return the next shot: the one before, unless the infant leaves it or gets small in it."""
        data, aspect = self._env.data, self.aspect
        spheres, wanted, passed_s = self.spheres, self._camera.shot(data), data.time - self._time_s
        if self.shot is None or passed_s < 0:  # Another episode: a cut.
            self._goal = wanted
            return wanted
        if not shows(self._goal, spheres, aspect) or wanted.depth_m < CLOSER * self._goal.depth_m:
            self._goal = wanted
        share = 1 - math.exp(-passed_s / FOLLOWING_S)
        while not shows(shot := _between(self.shot, self._goal, share), spheres, aspect) and share < 1:
            share = min(1.0, share + HURRY)
        return shot


class _Observed:
    """The pictures in an observation: as fine, as foveated and as late as the infant sees."""

    def __init__(self, cameras: Sequence[str]):
        self._cameras = cameras

    def pictures(self, data: mujoco.MjData, observation: Observation) -> list[Picture]:
        return [observation[camera] for camera in self._cameras]

    def close(self) -> None:
        """There is nothing to free."""


class _Sharp:
    """What eyes of full acuity see, of an infant that does not use them."""

    def __init__(self, model: mujoco.MjModel, cameras: Sequence[str], size_px: int):
        bodies = model.cam_bodyid[[model.camera(camera).id for camera in cameras]]
        own = {model.body(index).name for body in bodies for index in (body, model.body_parentid[body])}
        self._eyes = Eyes(model, cameras, SHARP * size_px, SHARP * size_px, own)

    def pictures(self, data: mujoco.MjData, observation: Observation) -> list[Picture]:
        return list(np.rint(average_down(self._eyes(data).astype(np.float32), SHARP)).astype(np.uint8))

    def close(self) -> None:
        self._eyes.close()


def _eyes_of(env: InfantEnv, size_px: int) -> _Observed | _Sharp:
    """Return what shows what the eyes see; *size_px* is the side of pictures that the infant does not see itself."""
    vision = env.manifest.senses.vision
    if vision is not None:
        return _Observed(vision.cameras)
    cameras = [eye for eye in EYES if mujoco.mj_name2id(env.model, mujoco.mjtObj.mjOBJ_CAMERA, eye) >= 0]
    if not cameras:
        raise RenderingError(f"'{env.manifest.name}' has no eyes; leave the eyes' view out")
    return _Sharp(env.model, cameras, size_px)


def _between(one: Shot, other: Shot, share: float) -> Shot:
    """Return the shot that has gone a share of the way from one to another, in the direction of the other."""
    return Shot(
        one.position_m + share * (other.position_m - one.position_m),
        one.depth_m + share * (other.depth_m - one.depth_m),
        other.view,
        one.fovy_deg + share * (other.fovy_deg - one.fovy_deg),
    )


def _beside(outside: Picture, seen: Sequence[Picture]) -> Picture:
    """Return a frame with a column of other pictures on the right, each as large as fits; their pixels stay square."""
    height = outside.shape[0]
    cell_px = _cell_px(height)
    fitted = [_fitted(picture, cell_px) for picture in seen]
    column = np.full((height, GAP_PX + max(picture.shape[1] for picture in fitted), 3), PAPER, np.uint8)
    for number, picture in enumerate(fitted):
        top = number * (height - cell_px)
        column[top : top + cell_px, GAP_PX : GAP_PX + picture.shape[1]] = picture
    return np.concatenate([outside, column], axis=1)


def _cell_px(height_px: int) -> int:
    """Return the height of the picture of an eye in a frame of a height: there are two, above each other."""
    return (height_px - GAP_PX) // 2


def _fitted(picture: Picture, height_px: int) -> Picture:
    """Return a picture of another height: averaged down if it is much higher, then by its nearest pixels."""
    times = max(1, min(picture.shape[0] // height_px, picture.shape[1]))
    rows, columns = (side // times * times for side in picture.shape[:2])
    smaller = np.rint(average_down(picture[:rows, :columns].astype(np.float32), times)).astype(np.uint8)
    height, width = smaller.shape[:2]
    width_px = max(1, round(width * height_px / height))
    return smaller[np.arange(height_px) * height // height_px][:, np.arange(width_px) * width // width_px]
