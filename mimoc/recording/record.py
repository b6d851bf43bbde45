"""Recording a run as a video in real time: infants, followed by a camera, and beside them the views of eyes."""

import io
import math
import wave
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from PIL import Image

from mimoc.base.errors import RenderingError, check_name
from mimoc.base.units import ms_to_s
from mimoc.bundle.files import write_file
from mimoc.components.senses.hearing.run import Hearing
from mimoc.components.senses.vision.eyes import Eyes
from mimoc.policies.rollout import Policies, Run
from mimoc.recording.video import Video, check_video, open_video
from mimoc.render.body_camera import BodyCamera, company, view_of_scene
from mimoc.render.camera import FROM_THE_SIDE, Shot, shows
from mimoc.render.picture_files import in_rows, rows_of
from mimoc.render.renderer import Picture, Shown, average_down
from mimoc.runtime.batch_env import infants_of
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import Observation

LOUDEST = 32_000
"""The loudest sample of a track, of 32,767: tracks are as loud as they can be, whatever their sound pressure."""
SUFFIX = ".wav"


def sound_file(video: str | Path) -> Path:
    """Return the file of the sound that belongs to a video."""
    return Path(video).expanduser().with_suffix(SUFFIX)


def hears(env: Infant) -> bool:
    """Return whether the infant of an environment has ears."""
    return isinstance(env.senses.get("hearing"), Hearing)


class SoundTrack:
    """What reaches an infant's ears, from the first time that it is asked, whatever its age hears of it."""

    def __init__(self, infant: Infant):
        self._infant, listener = infant, _hearing(infant).listener
        self.rate_hz = round(listener.rate_hz)
        self._index = listener.index
        self._blocks = list[npt.NDArray[np.float32]]()

    def hear(self) -> None:
        """Take what has reached the ears since the last time; call this after each control step."""
        listener = _hearing(self._infant).listener
        count = listener.index - (self._index if listener.index >= self._index else 0)  # Else an episode began.
        self._index = listener.index
        if count:
            self._blocks.append(listener.pressure_pa[:, -count:].astype(np.float32))

    @property
    def samples(self) -> npt.NDArray[np.int16]:
        """All of it, shape (n, 2), the left ear first; the loudest sample is `LOUDEST`."""
        pressure = np.concatenate([np.zeros((2, 0), np.float32), *self._blocks], axis=1)
        loudest = float(np.abs(pressure).max(initial=0.0)) or 1.0
        return np.rint(pressure.T * (LOUDEST / loudest)).astype(np.int16)

    def save(self, file: Path) -> Path:
        """Write a WAV file in stereo, and return its path."""
        content = io.BytesIO()
        with wave.open(content, "wb") as written:
            written.setnchannels(2)
            written.setsampwidth(2)
            written.setframerate(self.rate_hz)
            written.writeframes(self.samples.astype("<i2").tobytes())
        return write_file(file, content.getvalue())


def _hearing(env: Infant) -> Hearing:
    hearing = env.senses["hearing"]
    assert isinstance(hearing, Hearing)
    return hearing


SHAPE = 4 / 3  # Aspect ratio of the camera image.
SPACE = 1.25  # Margin of the field of view around the infant, so that limbs can move without moving the camera.
CLOSER = 0.7  # The camera moves closer when its distance would be reduced by this factor.
FOLLOWING_S = 1.0  # Time constant of the camera's motion.
HURRY = 0.1  # Step by which the camera's motion is sped up until the whole infant is in view.
GAP_PX = 4  # Gap between the images of a frame.
BACKGROUND = 255
SHARP = 2  # Factor of supersampling for the views of eyes that the infant does not observe.


class VideoFrames:
    """Renders the frames of a video of the infants of one simulation."""

    def __init__(self, infant: Infant, height_px: int, eyes: bool = False, shown: Shown = "skin"):
        """Open the cameras, or raise a RenderingError if OpenGL is not available, or the infant has no eyes."""
        self._env, self._eyes, self._height_px = infant, eyes, height_px
        self._shown: Shown = shown
        self.shot: Shot | None = None
        self._open()

    def _open(self) -> None:
        env = self._env
        height_px = self._height_px
        vision = self._env.manifest.senses.vision
        self._data = env.data
        self._observed = vision.cameras if self._eyes and vision else ()
        """Cameras whose images are observed, with the infant's acuity, foveation and delay."""
        self._sharp = _sharp_eyes(env, SHARP * _cell_px(height_px), self._shown) if self._eyes and not vision else None
        roots = [one.manifest.root_body for one in env.simulation.infants.values()]
        manifest = env.simulation.bundle.manifest
        view = view_of_scene(FROM_THE_SIDE, manifest, roots, env.data)
        size_px = (round(SHAPE * height_px), height_px)
        beside = company(manifest, roots, env.data)
        self.camera = BodyCamera(env.model, roots, *size_px, view, margin=SPACE, shown=self._shown, beside=beside)
        self.camera.turn(env.data)
        self._goal = self.camera.shot(env.data)
        self._time_s = env.data.time

    def frame(self, observation: Observation) -> Picture:
        """Return a frame of the current state and observation, shape (height, width, 3)."""
        if self._env.data is not self._data:  # An infant has grown, or is in another scene.
            self.close()
            self._open()
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
        spheres = self.camera.spheres(data)
        wanted = self.camera.shot(data)
        passed_s = data.time - self._time_s
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
    model = env.model
    cameras = [eye.camera for eye in env.manifest.anatomy.eyes]
    if not cameras:
        raise RenderingError(f"'{env.manifest.name}' has no eyes; record it without their views")
    bodies = model.cam_bodyid[[model.camera(camera).id for camera in cameras]]
    hidden = {model.body(index).name for body in bodies for index in (body, model.body_parentid[body])}
    return Eyes(model, cameras, size_px, size_px, hidden, shown)


def _between(one: Shot, other: Shot, share: float) -> Shot:
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
    return (height_px - GAP_PX) // 2


def _fitted(picture: Picture, height_px: int) -> Picture:
    width_px = max(1, round(picture.shape[1] * height_px / picture.shape[0]))
    return np.asarray(Image.fromarray(picture).resize((width_px, height_px), Image.Resampling.BOX))


RATE_HZ = 25  # Default frame rate: four hundredths of a second per frame, which a GIF can represent.
HEIGHT_PX = 360  # Default height of a video.
Watch = Callable[[Infant, Observation], None]  # Called with an infant and what it observes.
Filming = Callable[[Mapping[str, Infant], Mapping[str, Observation]], None]
"""Called with infants and with what they observe, by name."""


def record(
    env: Any,
    policy: Policies,
    file: str | Path,
    *,
    steps: int = 1000,
    seed: int = 0,
    infant: str | None = None,
    eyes: bool = False,
    rate_hz: int = RATE_HZ,
    height_px: int = HEIGHT_PX,
    body: Shown = "skin",
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Any:
    """Run infants under a policy, record a video, and return the summary of the run.

    The video plays in real time: all infants of a world are in one picture, and those of a vector environment in rows
    of pictures. What reaches the ears of an infant that hears is written beside it, as a stereo .wav file of the same
    name, and is the sound of an .mp4. After Ctrl-C, the video up to that point is kept; after any other error, no file
    is written.

    Args:
        env: The environment of one infant, a world of several, or a vector environment on the CPU, which is reset.
        policy: `random`, `zero`, `reach` or another name, a sum of names (`general_movements+reflexes`), a trained
            policy from `mimoc.load_policy`, or a function from an infant to a function from a random generator and an
            observation to an action; or a dictionary with the policy of each infant, by name.
        file: The video file, an .mp4 (which needs `pip install 'mimoc[record]'`) or a .gif.
        steps: Number of control steps.
        seed: Random seed of policy and episodes.
        infant: Name of the infant whose eyes and ears the video has, of several; by default, the first that has any.
        eyes: Whether to show the views of the eyes: the observed images or, without vision, unblurred views.
        rate_hz: Frames per second, at most one per control step.
        height_px: Height of the video.
        body: Whether infants are drawn with their `skin`, or their `solids`.
        progress: Called with the number of steps done and their total.

    Returns:
        The summary of the only infant, or those of several by name.

    Raises:
        OutputError: If the video cannot be written.
        MissingExtraError: If PyAV is not installed, which MP4 needs.
        UnknownNameError: If there is no such policy, or no such infant.
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
    infants = infants_of("record", env)
    if infant is not None:
        check_name("name of an infant of this environment", infant, infants)
    run = Run(env, policy, seed)
    step_ms = next(iter(infants.values())).manifest.step_ms
    with film_of(file, step_ms, infant=infant, eyes=eyes, rate_hz=rate_hz, height_px=height_px, body=body) as film:
        film(infants, run.observations)
        for done in range(1, steps + 1):
            run.step()
            film(infants, run.observations)
            progress(done, steps)
    summaries = run.summaries()
    return summaries.get("", summaries)


@contextmanager
def film_of(
    file: str | Path,
    step_ms: float,
    *,
    infant: str | None = None,
    eyes: bool = False,
    rate_hz: int = RATE_HZ,
    height_px: int = HEIGHT_PX,
    body: Shown = "skin",
) -> Iterator[Filming]:
    """Record a video of infants, as `record` does.

    Yield the function to call with the infants and what they observe, at the start and after each step.
    """
    step_s = Fraction(ms_to_s(step_ms)).limit_denominator(1_000_000)
    with ExitStack() as opened:
        frames = dict[str, VideoFrames]()
        video: Video | None = None
        track: SoundTrack | None = None
        seen, steps = dict[str, Observation](), 0

        def film(infants: Mapping[str, Infant], observations: Mapping[str, Observation]) -> None:
            nonlocal video, track, steps
            if video is None:
                shown = _shown(infants, infant)
                cell_px = height_px // len(rows_of(shown))
                for name in shown:
                    frames[name] = opened.enter_context(closing(VideoFrames(infants[name], cell_px, eyes, body)))
                video = open_video(file, min(Fraction(rate_hz), 1 / step_s))
                if heard := heard_in(infants, infant):
                    track = SoundTrack(heard)
                    video.open_sound(track.rate_hz)
            if track:
                track.hear()
            seen.update(observations)
            if steps * step_s * video.rate_hz >= video.pictures:
                pictures = [one.frame(seen.get(name, {})) for name, one in frames.items()]
                video.add(in_rows(pictures) if len(pictures) > 1 else pictures[0])
            steps += 1

        try:
            yield film
        except KeyboardInterrupt:
            _save(video, track)
            raise
        except BaseException:
            if video:
                video.discard()
            raise
        _save(video, track)


def heard_in(infants: Mapping[str, Infant], infant: str | None) -> Infant | None:
    """Return the infant whose ears a video of some has: that of a name, or the first that hears; None if none does."""
    chosen = infants.values() if infant is None else [infants[infant]]
    return next(filter(hears, chosen), None)


def _shown(infants: Mapping[str, Infant], infant: str | None) -> list[str]:
    """Return the name of one infant of each simulation, whose eyes are shown: that of a name, or the first."""
    names = dict[int, str]()
    for name, one in infants.items():
        if name == infant or id(one.simulation) not in names:
            names[id(one.simulation)] = name
    return [*names.values()]


def _save(video: Video | None, track: SoundTrack | None) -> None:
    """Write a video, if there is one, with its sound in it if it can be there, and in a file beside it."""
    if video is None:
        return
    video.save(track and track.samples)
    if track:
        track.save(sound_file(video.file))
