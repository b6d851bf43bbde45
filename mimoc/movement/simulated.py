"""Films of simulated infants: under a policy, or of recordings that are simulated again."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from pathlib import Path

from mimoc.base.errors import MovementError
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.environments import open_infant
from mimoc.movement.filming import SETTLING_S, Film, Filmed
from mimoc.policies.policy import PolicyMaker
from mimoc.recording.reading import read_recording
from mimoc.recordings import replay_recording
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.rollout import rollout
from mimoc.schema.infant import InfantSpec

SECONDS = 33.0
"""Length of the recordings of MINI-RGBD, within a third of a second."""
Progress = Callable[[int, int], None]


def no_progress(done: int, total: int) -> None:
    """Show nothing."""


def film_policy(
    infant: Bundle | InfantSpec | str | Path,
    policy: str | PolicyMaker,
    seeds: Sequence[int],
    seconds: float = SECONDS,
    progress: Progress = no_progress,
) -> Iterator[Filmed]:
    """Film an infant under a policy, once for each seed; the first second of an episode is left out.

    Args:
        infant: A bundle, the folder of one, or a spec.
        policy: Name of a policy, or a function from an environment to one.
        seeds: Seeds of the episode and of the policy, as of `mimoc run`.
        seconds: Length of each film.
        progress: Called with the number of control steps done and their total.

    Raises:
        UnknownNameError: If there is no such policy.
        MovementError: If an episode ends before it has been filmed.
    """
    with closing(open_infant(infant)) as env:
        step_s = ms_to_s(env.manifest.step_ms)
        steps = round((seconds + SETTLING_S) / step_s)
        label = policy if isinstance(policy, str) else env.manifest.name
        for number, seed in enumerate(seeds):
            film, done = Film(), number * steps
            for step in rollout(env, policy, steps=steps, seed=seed):
                if step.ended:
                    ended = f"the episode ended after {film.times_s[-1]:.1f} s; give fewer --seconds, or no task"
                    raise MovementError(f"{label}, seed {seed}: {ended}")
                film.watch(env)
                progress(done + step.number, len(seeds) * steps)
            yield film.develop(f"{label}, seed {seed}")


def film_recording(folder: Path, progress: Progress = no_progress, name: str = "") -> Iterator[Filmed]:
    """Simulate the episodes of a recording again, and film each; the first second of each is left out.

    Args:
        folder: The recording.
        progress: As of `film_policy`.
        name: What to call it; by default as its folder.

    Raises:
        RecordingError: If it is no whole recording.
        MovementError: If an episode does not come out again, or is too short.
    """
    film, recording, called = Film(), read_recording(folder), name or folder.name

    def watch(env: InfantEnv, _observation: object) -> None:
        film.watch(env)

    for replayed in replay_recording(recording, watch=watch, progress=progress):
        if replayed.difference is not None:
            raise MovementError(f"{folder}: cannot be measured, for it does not come out again: {replayed}")
        which = f"infant {replayed.episode.infant}, episode {replayed.episode.number}"
        yield film.develop(f"{called}, {which}" if len(recording) > 1 else called)
        film = Film()
