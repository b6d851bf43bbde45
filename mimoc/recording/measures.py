"""Quantities of recorded episodes: a row for each episode of one recording, or of all in a folder."""

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import RecordingError, UnknownNameError
from mimoc.base.kinds import function_of
from mimoc.base.movement_quantities import APART
from mimoc.base.quantities import QUANTITIES
from mimoc.base.quantity import Quantity
from mimoc.base.units import ms_to_s
from mimoc.recording.description import RECORDING
from mimoc.recording.reading import Episode, ReadRecording, read_recording
from mimoc.runtime.quantities import REDUCERS, EpisodeResult, Value, reduced

Progress = Callable[[int, int], None]
"""Called with how many recordings are done, and how many there are."""
MAX_RECORDINGS = 10_000  # Recordings in one folder.


def measurable() -> dict[str, Quantity]:
    """Return the quantities that recordings can tell: of movement columns, of episodes, and what plug-ins recorded."""
    return {name: quantity for name, quantity in QUANTITIES.items() if _is_measurable(quantity)}


def _is_measurable(quantity: Quantity) -> bool:
    is_of_columns = quantity.over == "movement"
    is_of_episodes = quantity.over == "episode" and "run" in quantity.steps and quantity.reduce != "count"
    is_recorded = "record" in quantity.steps
    return is_of_columns or is_of_episodes or is_recorded


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
    folder = Path(source).expanduser()
    known = measurable()
    for name in names:
        if name not in known:
            raise UnknownNameError("quantity of recordings", name, known)
    rows = list[dict[str, Any]]()
    paths = recordings_in(folder)
    for done, path in enumerate(paths):
        recording = read_recording(path)
        label = _label(path, folder)
        rows += [{"recording": label, **_row(recording, episode, names or known)} for episode in recording]
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
    descriptions = [*islice(folder.rglob(RECORDING), MAX_RECORDINGS + 1)]
    if not descriptions:
        raise RecordingError(f"{folder}: there is no recording here")
    if len(descriptions) > MAX_RECORDINGS:
        raise RecordingError(f"{folder}: more than {MAX_RECORDINGS} recordings are in this folder; divide it")
    return sorted(description.parent for description in descriptions)


def _label(path: Path, folder: Path) -> str:
    """Return what a recording is called in a table: its path below the folder, or the folder's own name."""
    return path.relative_to(folder).as_posix() if path != folder else folder.name


def mean_measures(folder: Path, step: str) -> dict[str, Value]:
    """Return the quantities of movement columns that a step of a cohort measures, as means over episodes."""
    quantities = {
        name: quantity
        for name, quantity in QUANTITIES.items()
        if quantity.over == "movement" and step in quantity.steps
    }
    episodes = [measure_episode(episode, quantities) for episode in read_recording(folder)]
    values = {name: [row[name] for row in episodes if row[name] is not None] for name in quantities}
    return {name: float(np.mean(np.array(column, float))) for name, column in values.items() if column}


def measure_episode(episode: Episode, quantities: Mapping[str, Quantity]) -> dict[str, Value]:
    """Return quantities of an episode by name; None for those that need what it does not have."""
    if not episode.steps:
        return dict.fromkeys(quantities)
    success_steps = np.flatnonzero(episode.infos.get("is_success", np.zeros(1)) == 1)
    steps = success_steps[0] + 1 if success_steps.size else episode.steps
    duration_s = float(steps) * ms_to_s(episode.step_ms)
    result = EpisodeResult(float(np.nansum(episode.rewards)), episode.steps, bool(success_steps.size), duration_s)
    columns = {"time_s": episode.time_s, **episode.movement}
    return {name: _value(quantity, episode, columns, result) for name, quantity in quantities.items()}


def _value(quantity: Quantity, episode: Episode, columns: Mapping[str, Any], result: EpisodeResult) -> Value:
    if quantity.over == "episode":
        return reduced(quantity, [getattr(result, quantity.key)])
    if quantity.over == "step":
        if quantity.name not in episode.measures:
            return None
        return reduced(quantity, episode.measures[quantity.name].tolist())
    try:
        if quantity.compute is not None:
            return function_of(quantity.compute, quantity.name)(columns)
        values = np.asarray(columns[quantity.key], float)
    except KeyError:
        return None
    return REDUCERS[quantity.reduce](values[np.isfinite(values)].tolist())


def _row(recording: ReadRecording, episode: Episode, names: Iterable[str]) -> dict[str, Any]:
    known = measurable()
    return {
        "infant": episode.infant,
        "name": recording.description.infants[episode.infant].name,
        "episode": episode.number,
        "seconds": ms_to_s(episode.steps * episode.step_ms),
        **measure_episode(episode, {name: known[name] for name in names}),
    }


TOUCHES, LOOKS_AT = "touches", "looks at"
ANY = "any"  # Stands for all parts together.
Flags = npt.NDArray[np.bool_]  # Whether something is so after each control step, shape (k,).


@takes("the folder of a recording", *PATH)
def contacts_and_gaze(source: str | Path, *, progress: Progress = lambda done, total: None) -> dict[str, list[Any]]:
    """Return who touches and looks at whom in recorded worlds as a tidy table: `pandas.DataFrame(...)` of it.

    Args:
        source: The folder of a recording, or of several.
        progress: Called with how many recordings have been read, and how many there are.

    Returns:
        Columns by name: `recording`, `episode`, `infant`, what it does (`touches` or `looks at`), its own `part`, the
        `other` infant and its `other_part`; and for how many `seconds`, which `share` of the episode that is, and how
        many `times` it began. `any` stands for all parts together; combinations of parts that do not occur have no row.

    Raises:
        RecordingError: If there is no recording of a world with several infants, or none has movement columns of
            contacts or gaze.

    Example:
        >>> import mimoc
        >>> kim = mimoc.load_spec("nine_months.yaml")
        >>> with mimoc.Recorder(mimoc.make_parallel({"anna": kim, "ben": kim}), "recordings/two") as env:
        ...     _ = env.reset(seed=0)
        ...     for _ in range(3):
        ...         _ = env.step({name: env.action_space(name).sample() for name in env.agents})
        >>> table = mimoc.contacts_and_gaze("recordings/two")
        >>> [*zip(table["infant"], table["does"], table["other"], table["seconds"])]
        [('anna', 'touches', 'ben', 0.0), ('anna', 'looks at', 'ben', 0.0), ('ben', 'touches', 'anna', 0.0), \
('ben', 'looks at', 'anna', 0.0)]
    """
    folder = Path(source).expanduser()
    rows = list[dict[str, Any]]()
    paths = recordings_in(folder)
    for done, path in enumerate(paths):
        recording = read_recording(path)
        label = _label(path, folder)
        rows += [{"recording": label, **row} for episode in recording for row in _rows(recording, episode)]
        progress(done + 1, len(paths))
    if not rows:
        raise RecordingError(
            f"{folder}: no world of several infants is recorded here with its contacts and gaze; record one with"
            " 'mimoc run WORLD --record DIR'"
        )
    return {name: [row[name] for row in rows] for name in rows[0]}


def _rows(recording: ReadRecording, episode: Episode) -> Iterator[dict[str, Any]]:
    """Yield how long an infant touches and looks at each other one in its world."""
    names = [recording.description.infants[number].name for number in recording.description.sharing(episode.infant)]
    own = recording.description.infants[episode.infant].name
    columns = episode.movement
    touched = {name.removesuffix("_touches"): name for name in columns if name.endswith("_touches")}
    looked = {"": "gaze_at"} if "gaze_at" in columns else {}
    for other in names if episode.steps else ():
        if other == own:
            continue
        for does, by_part in ((TOUCHES, touched), (LOOKS_AT, looked)):
            found = {
                (part, other_part): flags
                for part, column in by_part.items()
                for other_part, flags in _parts_of(other, names, columns[column][1:]).items()
            }
            together = np.any([np.zeros(episode.steps, bool), *found.values()], axis=0)
            whole = {(ANY if does == TOUCHES else "", ANY): together} if by_part else {}
            for (part, other_part), flags in {**whole, **found}.items():
                yield {
                    "episode": episode.number,
                    "infant": own,
                    "does": does,
                    "part": part,
                    "other": other,
                    "other_part": other_part,
                    "seconds": ms_to_s(int(flags.sum()) * episode.step_ms),
                    "share": float(flags.mean()),
                    "times": int(np.count_nonzero(np.diff(flags, prepend=False) & flags)),
                }


def _parts_of(other: str, names: Sequence[str], texts: npt.NDArray[Any]) -> dict[str, Flags]:
    """Return at which steps texts name a part of another infant, for each such part, by its name without the infant's.

    Args:
        other: Name of the other infant.
        names: Names of all infants in the world.
        texts: Names of things at each control step, shape (k,).
    """
    found = dict[str, Flags]()
    for text in set(texts.tolist()):
        for part in _parts_in(text, other, names):
            found[part] = found.get(part, np.zeros(len(texts), bool)) | (texts == text)
    return dict(sorted(found.items()))


def _parts_in(text: str, other: str, names: Sequence[str]) -> list[str]:
    """Return the parts of the infant *other* in a list of things; `ben_2_head` is a part of `ben_2` if there is one."""
    parts = list[str]()
    for thing in text.split(APART):
        owners = [name for name in names if thing.startswith(f"{name}_")]
        if max(owners, key=len, default="") == other:
            parts.append(thing.removeprefix(f"{other}_"))
    return parts
