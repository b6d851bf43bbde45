"""Recording a run as a video in real time: the infant, followed by a camera, and beside it the views of its eyes."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

import gymnasium
import numpy as np
from PIL import Image

from mimoc.base.errors import RenderingError
from mimoc.base.units import ms_to_s
from mimoc.policies.policy import PolicyMaker
from mimoc.recording.sound_track import SoundTrack, hears, sound_file
from mimoc.recording.video import Video, check_video, open_video
from mimoc.render.body_camera import BodyCamera, company, view_of_scene
from mimoc.render.camera import FROM_THE_SIDE, Shot, shows
from mimoc.render.renderer import Picture, Shown, average_down
from mimoc.runtime.env import InfantEnv, infant_of
from mimoc.runtime.infant import Infant
from mimoc.runtime.rollout import Run, Summary
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


class VideoFrames:
    """Renders the frames of a video of one environment."""

    def __init__(
        self,
        env: Infant,
        height_px: int,
        eyes: bool = False,
        shown: Shown = "skin",
        roots: Sequence[str] = (),
    ):
        """Open the cameras, or raise a RenderingError if OpenGL is not available, or the infant has no eyes.

        Without *roots*, root bodies of several infants, only this infant is kept in the picture.
        """
        self._env, vision = env, env.manifest.senses.vision
        self._observed = vision.cameras if eyes and vision else ()
        """Cameras whose images are observed, with the infant's acuity, foveation and delay."""
        self._sharp = _sharp_eyes(env, SHARP * _cell_px(height_px), shown) if eyes and not vision else None
        roots = roots or [env.manifest.root_body]
        view = view_of_scene(FROM_THE_SIDE, env.manifest, roots, env.data)
        size_px, beside = (round(SHAPE * height_px), height_px), company(env.manifest, roots, env.data)
        self.camera = BodyCamera(env.model, roots, *size_px, view, margin=SPACE, shown=shown, beside=beside)
        """The camera outside."""
        self.camera.turn(env.data)
        self.shot: Shot | None = None
        """Shot of the last frame."""
        self._goal = self.camera.shot(env.data)
        """Shot that the camera is moving to."""
        self._time_s = 0.0

    def frame(self, observation: Observation) -> Picture:
        """Return a frame of the current state and observation, shape (height, width, 3)."""
        self.shot = self._followed()
        self._time_s = self._env.data.time
        outside = self.camera.render(self._env.data, shot=self.shot)
        seen = [observation[camera] for camera in self._observed]
        if self._sharp:
            sharp = average_down(self._sharp(self._env.data).astype(np.float32), SHARP)
            seen = list(np.rint(sharp).astype(np.uint8))
        return _beside(outside, seen) if seen else outside

    def close(self) -> None:
        """Free the OpenGL contexts; closing twice is fine."""
        self.camera.close()
        if self._sharp:
            self._sharp.close()

    def _followed(self) -> Shot:
        """Return the next shot: the previous one, unless the infant leaves it or becomes small in it."""
        data, aspect = self._env.data, self.camera.aspect
        spheres, wanted, passed_s = self.camera.spheres(data), self.camera.shot(data), data.time - self._time_s
        if self.shot is None or passed_s < 0:  # A new episode: cut.
            self._goal = wanted
            return wanted
        if not shows(self._goal, spheres, aspect) or wanted.depth_m < CLOSER * self._goal.depth_m:
            self._goal = wanted
        share = 1 - math.exp(-passed_s / FOLLOWING_S)
        while not shows(shot := _between(self.shot, self._goal, share), spheres, aspect) and share < 1:
            share = min(1.0, share + HURRY)
        return shot


def _sharp_eyes(env: Infant, size_px: int, shown: Shown) -> Eyes:
    """Return what draws unblurred views of the eyes of an infant without vision, without its head in the way."""
    model, cameras = env.model, [eye.camera for eye in env.manifest.anatomy.eyes]
    if not cameras:
        raise RenderingError(f"'{env.manifest.name}' has no eyes; record it without their views")
    bodies = model.cam_bodyid[[model.camera(camera).id for camera in cameras]]
    hidden = {model.body(index).name for body in bodies for index in (body, model.body_parentid[body])}
    return Eyes(model, cameras, size_px, size_px, hidden, shown)


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
    """Return an image scaled to another height: averaged if larger, by nearest neighbour if smaller."""
    width_px = max(1, round(picture.shape[1] * height_px / picture.shape[0]))
    return np.asarray(Image.fromarray(picture).resize((width_px, height_px), Image.Resampling.BOX))


RATE_HZ = 25
"""Default frame rate: four hundredths of a second per frame, which a GIF can represent."""
HEIGHT_PX = 360
"""Default height of a video."""
Watch = Callable[[InfantEnv, Observation], None]
"""Called with an environment and what it observes."""


def record(
    env: gymnasium.Env[Any, Any],
    policy: str | PolicyMaker,
    file: str | Path,
    *,
    steps: int = 1000,
    seed: int = 0,
    eyes: bool = False,
    rate_hz: int = RATE_HZ,
    height_px: int = HEIGHT_PX,
    body: Shown = "skin",
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Summary:
    """Run an infant under a policy, record a video, and return the summary of the run.

    The video plays in real time. Of an infant that hears, what reaches its ears is written beside it, as a stereo .wav
    file of the same name, and is the sound of an .mp4. After Ctrl-C, the video up to that point is kept; after any
    other error, no file is written.

    Args:
        env: The environment of one infant, which is reset.
        policy: `random`, `zero`, `reach` or another name, a sum of names (`general_movements+reflexes`), a trained
            policy from `mimoc.load_policy`, or a function from an environment to a function from a random generator
            and an observation to an action.
        file: The video file, an .mp4 (which needs `pip install 'mimoc[record]'`) or a .gif.
        steps: Number of control steps.
        seed: Random seed of policy and episodes.
        eyes: Whether to show the views of the eyes: the observed images or, without vision, unblurred views.
        rate_hz: Frames per second, at most one per control step.
        height_px: Height of the video.
        body: Whether infants are drawn with their `skin`, or their `solids`.
        progress: Called with the number of steps done and their total.

    Raises:
        OutputError: If the video cannot be written.
        MissingExtraError: If PyAV is not installed, which MP4 needs.
        UnknownNameError: If there is no such policy.
        PolicyError: If its name lacks something, or it does not fit the infant.
        RenderingError: If OpenGL is not available, or the infant has no eyes.
        TypeError: If it is no such environment.

    Example:
        >>> import mimoc
        >>> env = mimoc.make("nine_months.yaml")
        >>> summary = mimoc.record(env, "random", "moving.gif", steps=8, height_px=48)
        >>> summary.steps
        8
    """
    check_video(file)
    infant = infant_of(
        "record", env, "make one with mimoc.make, or film a world with: mimoc run WORLD.yaml --video FILE"
    )
    run = Run(infant, policy, seed)
    with film_of(file, infant.manifest.step_ms, eyes=eyes, rate_hz=rate_hz, height_px=height_px, body=body) as watch:
        watch(infant, run.observation)
        for done in range(1, steps + 1):
            run.step()
            watch(infant, run.observation)
            progress(done, steps)
    return run.summary()


@contextmanager
def film_of(
    file: str | Path,
    step_ms: float,
    *,
    eyes: bool = False,
    rate_hz: int = RATE_HZ,
    height_px: int = HEIGHT_PX,
    body: Shown = "skin",
    roots: Sequence[str] = (),
) -> Iterator[Watch]:
    """Record a video of one environment, as `record` does, or of several infants with some root bodies.

    Yield the function to call with the environment and what it observes, at the start and after each step.
    """
    step_s = Fraction(ms_to_s(step_ms)).limit_denominator(1_000_000)
    with ExitStack() as opened:
        film: VideoFrames | None = None
        video: Video | None = None
        track: SoundTrack | None = None
        steps = 0

        def watch(env: Infant, observation: Observation) -> None:
            """Capture a frame if one is due."""
            nonlocal film, video, track, steps
            if film is None or video is None:
                film = opened.enter_context(closing(VideoFrames(env, height_px, eyes, body, roots)))
                video = open_video(file, min(Fraction(rate_hz), 1 / step_s))
                track = _open_track(env, video)
            if track:
                track.hear(env)
            if steps * step_s * video.rate_hz >= video.pictures:
                video.add(film.frame(observation))
            steps += 1

        try:
            yield watch
        except KeyboardInterrupt:
            _save(video, track)
            raise
        except BaseException:
            if video:
                video.discard()
            raise
        _save(video, track)


def _open_track(env: Infant, video: Video) -> SoundTrack | None:
    """Return the sound of a video without frames, if its infant hears."""
    if not hears(env):
        return None
    track = SoundTrack(env)
    video.open_sound(track.rate_hz)
    return track


def _save(video: Video | None, track: SoundTrack | None) -> None:
    """Write a video, if there is one, with its sound in it if it can be there, and in a file beside it."""
    if video is None:
        return
    video.save(track and track.samples)
    if track:
        track.save(sound_file(video.file))
