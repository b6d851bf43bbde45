"""Quantities of recorded episodes: a row for each episode of one recording, or of all in a folder."""

from collections.abc import Callable, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import RecordingError, UnknownNameError
from mimoc.base.kinds import function_of
from mimoc.base.units import ms_to_s
from mimoc.quantities import QUANTITIES
from mimoc.quantities.measuring import REDUCERS, Outcome, Value, reduced
from mimoc.quantities.quantity import Quantity
from mimoc.recording.description import RECORDING
from mimoc.recording.reading import Episode, ReadRecording, read_recording

Progress = Callable[[int, int], None]
MOST = 10_000
"""Recordings in one folder."""


def measurable() -> dict[str, Quantity]:
    """Return the quantities that recordings can tell: of movement columns, of episodes, and what plug-ins recorded."""
    return {
        name: item
        for name, item in QUANTITIES.items()
        if item.over == "movement"
        or (item.over == "episode" and "run" in item.steps and item.reduce != "count")
        or "record" in item.steps
    }


@takes("the folder of a recording", *PATH)
def measure_recordings(
    source: str | Path, names: Sequence[str] = (), *, progress: Progress = lambda done, total: None
) -> dict[str, list[Any]]:
    """Return quantities of recorded episodes as a tidy table: `pandas.DataFrame(measure_recordings(...))`.

    Args:
        source: The folder of a recording, or of several: of a cohort, say.
        names: The quantities; by default, all that any of the episodes has.
        progress: Called with how many recordings have been measured, and how many there are.

    Returns:
        Columns by name, with a row for each episode: `recording`, `infant`, its `name`, `episode`, `seconds` and the
        quantities; None where an episode does not have what a quantity needs.

    Raises:
        RecordingError: If there is no recording, or no episode has what a named quantity needs.
        UnknownNameError: If there is no such quantity.

    Example:
        >>> import mimoc
        >>> table = mimoc.measure_recordings("recordings/reach", ["right_hand_path_m", "right_hand_movement_units"])
        >>> [*table], table["right_hand_movement_units"]
        (['recording', 'infant', 'name', 'episode', 'seconds', 'right_hand_path_m', 'right_hand_movement_units'], [0])
    """
    folder, known = Path(source).expanduser(), measurable()
    for name in names:
        if name not in known:
            raise UnknownNameError("quantity of recordings", name, known)
    rows, paths = [], recordings_in(folder)
    for done, path in enumerate(paths):
        recording = read_recording(path)
        where = path.relative_to(folder).as_posix() if path != folder else folder.name
        rows += [{"recording": where, **_row(recording, episode, names or known)} for episode in recording]
        progress(done + 1, len(paths))
    if not rows:
        raise RecordingError(f"{folder}: there are no episodes in this recording")
    empty = [name for name in known if name in rows[0] and all(row[name] is None for row in rows)]
    if missing := [name for name in names if name in empty]:
        advice = "record it with 'mimoc run INFANT --record DIR', which keeps movement columns"
        raise RecordingError(f"{folder}: no episode has what '{missing[0]}' needs; {advice}")
    return {name: [row[name] for row in rows] for name in rows[0] if name not in empty}


def recordings_in(folder: Path) -> list[Path]:
    """Return the folder of a recording, or the folders of all recordings below one, in order."""
    if not folder.is_dir():
        raise RecordingError(f"{folder}: there is no such folder; record one with 'mimoc run INFANT --record DIR'")
    if (folder / RECORDING).is_file():
        return [folder]
    marks = [*islice(folder.rglob(RECORDING), MOST + 1)]
    if not marks or len(marks) > MOST:
        count = f"more than {MOST} recordings are in this folder; divide it" if marks else "there is no recording here"
        raise RecordingError(f"{folder}: {count}")
    return sorted(mark.parent for mark in marks)


def mean_measures(folder: Path, step: str) -> dict[str, Value]:
    """Return the quantities of movement columns that a step of a cohort measures, as means over episodes."""
    quantities = {name: item for name, item in QUANTITIES.items() if item.over == "movement" and step in item.steps}
    episodes = [measure_episode(episode, quantities) for episode in read_recording(folder)]
    values = {name: [row[name] for row in episodes if row[name] is not None] for name in quantities}
    return {name: float(np.mean(np.array(column, float))) for name, column in values.items() if column}


def measure_episode(episode: Episode, quantities: Mapping[str, Quantity]) -> dict[str, Value]:
    """Return quantities of an episode by name; None for those that need what it does not have."""
    if not episode.steps:
        return dict.fromkeys(quantities)
    success, step_s = np.flatnonzero(episode.infos.get("is_success", np.zeros(1)) == 1), ms_to_s(episode.step_ms)
    time_s = float(success[0] + 1) * step_s if success.size else None
    outcome = Outcome(float(np.nansum(episode.rewards)), episode.steps, bool(success.size), time_s)
    columns = {"time_s": episode.time_s, **episode.movement}
    return {name: _value(item, episode, columns, outcome) for name, item in quantities.items()}


def _value(item: Quantity, episode: Episode, columns: Mapping[str, Any], outcome: Outcome) -> Value:
    if item.over == "episode":
        return reduced(item, [getattr(outcome, item.key)])
    if item.over == "step":
        return reduced(item, episode.measures[item.name].tolist()) if item.name in episode.measures else None
    try:
        if item.compute is not None:
            return function_of(item.compute, item.name)(columns)
        values = np.asarray(columns[item.key], float)
    except KeyError:
        return None
    return REDUCERS[item.reduce](values[np.isfinite(values)].tolist())


def _row(recording: ReadRecording, episode: Episode, names: Any) -> dict[str, Any]:
    known = measurable()
    which = {"infant": episode.infant, "name": recording.description.infants[episode.infant].name}
    which |= {"episode": episode.number, "seconds": ms_to_s(episode.steps * episode.step_ms)}
    return which | measure_episode(episode, {name: known[name] for name in names})
