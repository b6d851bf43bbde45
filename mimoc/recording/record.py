"""Recording a run as a video in real time."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing, contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

import gymnasium

from mimoc.recording.film import VideoFrames
from mimoc.recording.video import Video, check_video, open_video
from mimoc.render.renderer import Shown
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.rollout import PolicyMaker, Run, Summary
from mimoc.senses.sense import Observation
from mimoc.units import ms_to_s

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

    The video plays in real time. After Ctrl-C, the video up to that point is kept; after any other error, no file is
    written.

    Args:
        env: The environment, which is reset.
        policy: `random`, `zero`, `reach`, a trained policy from `mimoc.load_policy`, or a function from an environment
            to a function from a random generator and an observation to an action.
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
        RenderingError: If OpenGL is not available, or the infant has no eyes.

    Example:
        >>> import mimoc
        >>> env = mimoc.make("nine_months.yaml")
        >>> summary = mimoc.record(env, "random", "moving.gif", steps=8, height_px=48)
        >>> summary.steps
        8
    """
    check_video(file)
    infant = env.unwrapped
    if not isinstance(infant, InfantEnv):
        raise TypeError(f"expected an environment of mimoc's, got {type(infant).__name__}")
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
) -> Iterator[Watch]:
    """Record a video of one environment, as `record` does.

    Yield the function to call with the environment and what it observes, at the start and after each step.
    """
    step_s = Fraction(ms_to_s(step_ms)).limit_denominator(1_000_000)
    with ExitStack() as opened:
        film: VideoFrames | None = None
        video: Video | None = None
        steps = 0

        def watch(env: InfantEnv, observation: Observation) -> None:
            """Capture a frame if one is due."""
            nonlocal film, video, steps
            if film is None or video is None:
                film = opened.enter_context(closing(VideoFrames(env, height_px, eyes, body)))
                video = open_video(file, min(Fraction(rate_hz), 1 / step_s))
            if steps * step_s * video.rate_hz >= video.pictures:
                video.add(film.frame(observation))
            steps += 1

        try:
            yield watch
        except KeyboardInterrupt:
            _save(video)
            raise
        except BaseException:
            if video:
                video.discard()
            raise
        _save(video)


def _save(video: Video | None) -> None:
    """Save a video, or discard it if that fails or is interrupted."""
    if video is None:
        return
    try:
        video.save()
    except BaseException:
        video.discard()
        raise
