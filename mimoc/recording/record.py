"""Filming a run: pictures from outside and of the eyes' view, at the speed of real time."""

from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from fractions import Fraction
from pathlib import Path
from typing import Any

import gymnasium

from mimoc.recording.film import Film
from mimoc.recording.video import Video, check_video, open_video
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.rollout import PolicyMaker, Run, Summary
from mimoc.units import ms_to_s

RATE_HZ = 25
"""Pictures a second: four hundredths of a second each, which a GIF can say."""
HEIGHT_PX = 360
"""Of a film."""
Look = Callable[[], None]
"""Is called after each control step, and takes a picture when it is time for one."""


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
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Summary:
    """Run an infant under a policy, film it, and return what happened.

    The film runs at the speed of real time. Ctrl-C ends it: what was filmed until then is kept. Nothing is left of it
    after any other error.

    Args:
        env: The environment, which is reset.
        policy: What acts: `random`, `zero`, `reach`, what `mimoc.load_policy` returns, or a function from the
            environment to a function from a random generator and an observation to an action.
        file: Where the film goes, an .mp4 (which needs `pip install 'mimoc[record]'`) or a .gif.
        steps: Control steps to run.
        seed: Of the policy and the episodes.
        eyes: Whether to show beside it what the eyes see: what the infant observes, if it has vision; else sharp.
        rate_hz: Pictures a second, at most one each control step.
        height_px: Of the film.
        progress: Is told how many steps of how many are done.

    Raises:
        OutputError: If the film cannot be written there.
        MissingExtraError: If PyAV is not installed, which MP4 needs.
        UnknownNameError: If there is no such policy.
        RenderingError: If there is no OpenGL here, or the infant has no eyes to show.
    """
    check_video(file)
    infant = env.unwrapped
    if not isinstance(infant, InfantEnv):
        raise TypeError(f"record films an infant's environment, not {type(infant).__name__}")
    run = Run(infant, policy, seed)
    with filming(run, file, eyes=eyes, rate_hz=rate_hz, height_px=height_px) as look:
        for done in range(1, steps + 1):
            run.step()
            look()
            progress(done, steps)
    return run.summary()


@contextmanager
def filming(
    run: Run, file: str | Path, *, eyes: bool = False, rate_hz: int = RATE_HZ, height_px: int = HEIGHT_PX
) -> Iterator[Look]:
    """Film a run, as `record` does; what it yields is to be called after each step."""
    step_s = Fraction(ms_to_s(run.env.manifest.step_ms)).limit_denominator(1_000_000)
    with closing(Film(run.env, height_px, eyes)) as film:
        video = open_video(file, min(Fraction(rate_hz), 1 / step_s))
        try:
            yield _looker(run, film, video, step_s)
        except KeyboardInterrupt:
            _keep(video)
            raise
        except BaseException:
            video.discard()
            raise
        _keep(video)


def _keep(video: Video) -> None:
    """Put a video into its place, or leave nothing if that fails or is interrupted."""
    try:
        video.save()
    except BaseException:
        video.discard()
        raise


def _looker(run: Run, film: Film, video: Video, step_s: Fraction) -> Look:
    """Return what takes the first picture now, and each other one when its time has come."""
    taken = -1

    def look() -> None:
        nonlocal taken
        taken += 1
        if taken * step_s * video.rate_hz >= video.pictures:
            video.add(film.frame(run.observation))

    look()
    return look
