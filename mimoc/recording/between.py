"""Contacts and gaze between the infants of recorded worlds: who touches and looks at whom, and where."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.classes import PATH, takes
from mimoc.base.errors import RecordingError
from mimoc.base.units import ms_to_s
from mimoc.columns.forces import APART
from mimoc.recording.measures import Progress, recordings_in
from mimoc.recording.reading import Episode, ReadRecording, read_recording

TOUCHES, LOOKS_AT = "touches", "looks at"
ANY = "any"
"""Stands for all parts together."""
Flags = npt.NDArray[np.bool_]
"""Whether something is so after each control step, shape (k,)."""


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
    folder, rows = Path(source).expanduser(), list[dict[str, Any]]()
    paths = recordings_in(folder)
    for done, path in enumerate(paths):
        name, recording = path.relative_to(folder).as_posix() if path != folder else folder.name, read_recording(path)
        rows += [{"recording": name, **row} for episode in recording for row in _rows(recording, episode)]
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
    own, columns, step_s = recording.description.infants[episode.infant].name, episode.movement, episode.step_ms
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
                seconds = ms_to_s(int(flags.sum()) * step_s)
                yield {
                    "episode": episode.number,
                    "infant": own,
                    "does": does,
                    "part": part,
                    "other": other,
                    "other_part": other_part,
                    "seconds": seconds,
                    "share": float(flags.mean()),
                    "times": int(np.count_nonzero(np.diff(flags, prepend=False) & flags)),
                }


def _parts_of(other: str, names: Sequence[str], texts: npt.NDArray[Any]) -> dict[str, Flags]:
    """Return for each part of another infant that texts name when they do, by the part's name without the infant's."""
    found, named = dict[str, Flags](), {text: _parts_in(text, other, names) for text in set(texts.tolist())}
    for text, parts in named.items():
        for part in parts:
            found[part] = found.get(part, np.zeros(len(texts), bool)) | (texts == text)
    return dict(sorted(found.items()))


def _parts_in(text: str, other: str, names: Sequence[str]) -> list[str]:
    """Return the parts of an infant in a list of things; `ben_2_head` is a part of `ben_2` if there is one."""
    parts = list[str]()
    for thing in text.split(APART):
        owners = [name for name in names if thing.startswith(f"{name}_")]
        if max(owners, key=len, default="") == other:
            parts.append(thing.removeprefix(f"{other}_"))
    return parts
