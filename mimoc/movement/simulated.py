"""Films of simulated infants: under a policy, or of recordings that are simulated again."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from pathlib import Path
from typing import Any

from mimoc.base.errors import MovementError
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.world import WorldBundle
from mimoc.movement.filming import SETTLING_S, Film, Filmed
from mimoc.policies.policy import PolicyMaker
from mimoc.policies.rollout import rollout
from mimoc.recording.reading import read_recording
from mimoc.recording.replay_recording import replay_recording
from mimoc.runtime.infant import Infant
from mimoc.runtime.infants import infants_of
from mimoc.runtime.opening.environments import open_infant
from mimoc.runtime.opening.parallel import is_world_source, shared_world
from mimoc.schema.infant import InfantSpec

SECONDS = 33.0
"""Length of the recordings of MINI-RGBD, within a third of a second."""
Progress = Callable[[int, int], None]


def no_progress(done: int, total: int) -> None:
    """Show nothing."""


def film_policy(
    infant: Bundle | WorldBundle | InfantSpec | str | Path,
    policy: str | PolicyMaker,
    seeds: Sequence[int],
    seconds: float = SECONDS,
    progress: Progress = no_progress,
) -> Iterator[Filmed]:
    """Film infants of a spec, a bundle or a world under a policy, for each seed, but for the first second.

    Raises an UnknownNameError for an unknown policy, and a MovementError if an episode ends before it is filmed.
    """
    source: Any = infant
    with closing(shared_world(source) if is_world_source(source) else open_infant(source)) as env:
        infants, step_s = infants_of("film_policy", env), ms_to_s(env.bundle.manifest.step_ms)
        steps = round((seconds + SETTLING_S) / step_s)
        label = policy if isinstance(policy, str) else env.bundle.manifest.name
        for number, seed in enumerate(seeds):
            films, done = {name: Film() for name in infants}, number * steps
            for step in rollout(env, policy, steps=steps, seed=seed):
                film = films[step.infant]
                if step.ended:
                    ended = f"the episode ended after {film.times_s[-1]:.1f} s; give fewer --seconds, or no task"
                    raise MovementError(f"{label}, seed {seed}: {ended}")
                film.watch(infants[step.infant])
                progress(done + step.number, len(seeds) * steps)
            for name, film in films.items():
                yield film.develop(f"{label}, seed {seed}" + (f", {name}" if name else ""))


def film_recording(folder: Path, progress: Progress = no_progress, name: str = "") -> Iterator[Filmed]:
    """Simulate the episodes of a recording again, and film each; the first second of each is left out.

    Raises a RecordingError if it is not whole, a MovementError if an episode is too short or does not come out again.
    """
    film, recording, called = Film(), read_recording(folder), name or folder.name
    steps = [sum(episode.steps for episode in recording.of_infant(number)) for number in range(recording.infants)]

    def watch(infant: Infant, _observation: object) -> None:
        film.watch(infant)

    for number, infant in enumerate(recording.description.infants):
        done, who = sum(steps[:number]), f"infant {number}" if infant.world is None else infant.name
        show = lambda steps_done, _, before=done: progress(before + steps_done, sum(steps))  # noqa: E731
        chosen = {"infant": number, "watch": watch, "progress": show}
        for replayed in replay_recording(recording, **chosen) if recording.of_infant(number) else ():
            if replayed.difference is not None:
                raise MovementError(f"{folder}: cannot be measured, for it does not come out again: {replayed}")
            which = f"{called}, {who}, episode {replayed.episode.number}"
            yield film.develop(which if len(recording) > 1 else called)
            film = Film()
