"""Simulating recordings again: in environments that are opened from the bundles they contain."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from copy import deepcopy
from pathlib import Path
from types import MappingProxyType
from typing import Any

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import RecordingError
from mimoc.bundle.io import Bundle
from mimoc.bundle.world import WorldBundle
from mimoc.recording.reading import Episode, ReadRecording, read_recording
from mimoc.recording.record import Watch
from mimoc.recording.replaying import Replayed, replay
from mimoc.runtime.opening.environments import open_bundle
from mimoc.runtime.world_env import WorldEnv

NONE: Mapping[str, Any] = MappingProxyType({})


@takes("a recording, or the folder of one", ReadRecording, *PATH)
def replay_recording(
    recording: ReadRecording | str | Path,
    *,
    infant: int | str | None = None,
    episode: int | None = None,
    task: Any = None,
    senses: Mapping[str, Any] = NONE,
    companions: Mapping[str, Any] = NONE,
    watch: Watch = lambda env, observation: None,
    progress: Callable[[int, int], None] = lambda done, total: None,
) -> Iterator[Replayed]:
    """Simulate a recording again, and yield for each episode the first number that did not come out again, if any.

    With the same version of MuJoCo on the same type of machine, every number is the same to the bit.

    Args:
        recording: The recording, or its folder.
        infant: Only the episodes of this one, given by its number or its name.
        episode: Only the episode of this number of each infant.
        task: A task of the script's own that was recorded, as for `mimoc.make`; of a world, tasks by infant.
        senses: Likewise senses, by name.
        companions: Likewise companions, by name.
        watch: Called with an infant and its observation after each reset and each control step; of a world, with the
            first of the chosen infants whose episode goes on.
        progress: Called with the number of control steps done and their total.

    Raises:
        RecordingError: If this is no recording, it is damaged, has no such episodes, or needs such objects.
        RenderingError: If the infant has vision, and there is no OpenGL here.

    Example:
        >>> import mimoc
        >>> [replayed.difference for replayed in mimoc.replay_recording("recordings/reach")]
        [None]
    """
    opened = recording if isinstance(recording, ReadRecording) else read_recording(recording)
    episodes = chosen_episodes(opened, infant, episode)
    for one in episodes:
        given = _given(opened, one.infant, task, senses, companions)
        for what, name in one.objects.items():
            if what not in given:
                raise RecordingError(f"{opened.path}: recorded with {what} of a script's own ({name}); pass it as well")

    def open_env(bundle: Bundle | WorldBundle, other_scenes: bool) -> Any:
        objects: Any = deepcopy({"senses": dict(senses), "companions": dict(companions)})
        if isinstance(bundle, WorldBundle):
            from mimoc.compiler.world_variants import WorldBundleVariants, WorldVariants, plan_of_bundle

            variants = WorldVariants(plan_of_bundle(bundle)) if other_scenes else WorldBundleVariants(bundle)
            return WorldEnv(bundle, variants=variants, tasks=deepcopy(task or {}), **objects)
        return open_bundle(bundle, other_scenes, task=deepcopy(task), **objects)

    return replay(opened, open_env, episodes=episodes, watch=watch, progress=progress)


def _given(
    recording: ReadRecording, infant: int, task: Any, senses: Mapping[str, Any], companions: Mapping[str, Any]
) -> set[str]:
    about = recording.description.infants[infant]
    if about.world is not None:
        task, senses, companions = (by_name.get(about.name, {}) for by_name in (task or {}, senses, companions))
        task = task or None
    given = {f"senses.{name}" for name in senses} | {f"companions.{name}" for name in companions}
    return given | ({"task"} if task is not None else set())


def chosen_episodes(recording: ReadRecording, infant: int | str | None, episode: int | None) -> Sequence[Episode]:
    """Return the episodes of an infant, of a number, or all, or raise a RecordingError if there are none."""
    if infant is not None:
        infant = recording.infant_number(infant)
    chosen = [one for one in recording if infant in (None, one.infant) and episode in (None, one.number)]
    if not chosen:
        which = [f"{name} {value}" for name, value in (("infant", infant), ("episode", episode)) if value is not None]
        raise RecordingError(f"{recording.path}: there is nothing recorded{' of ' if which else ''}{', '.join(which)}")
    return chosen
