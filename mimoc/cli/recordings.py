"""`mimoc replay`, `mimoc measure` and `mimoc export`: what becomes of recordings."""

import csv
import io
import sys
from collections.abc import Container, Iterable, Mapping, Sequence
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mimoc.base.errors import MimocError, counted
from mimoc.base.kinds import announced
from mimoc.base.rounding import readable
from mimoc.cli.arguments import Body, Eyes, RecordingPath, ShownBody, VideoHeight, check_video, import_object
from mimoc.cli.terminal import FAILED_CHECK, printable
from mimoc.schema.kinds import EXPORTERS

if TYPE_CHECKING:
    from mimoc.base.quantities import Quantity
    from mimoc.runtime.infant import Infant

OwnTask = Annotated[
    str | None, typer.Option(metavar="MODULE:CLASS", help="The class of your own that the rewards were taken from.")
]


def replay(
    recording: RecordingPath,
    infant: Annotated[
        str | None, typer.Option(metavar="NAME", help="Replay only this one of several infants, by name or number.")
    ] = None,
    episode: Annotated[int | None, typer.Option(min=0, help="Replay only the episode of this number.")] = None,
    task: OwnTask = None,
    video: Annotated[Path | None, typer.Option(metavar="FILE", help="Make a video of it: .mp4 or .gif.")] = None,
    eyes: Eyes = False,
    size: VideoHeight = 360,
    body: ShownBody = Body.SKIN,
) -> None:
    """Simulate a recording again, and say whether every number comes out again; exit code 1 if not."""
    from mimoc.cli import console
    from mimoc.recording import replaying as recordings
    from mimoc.recording.reading import read_recording
    from mimoc.recording.record import film_of

    check_video(video, eyes)
    recorded = read_recording(recording)
    if video and infant is None and len(recorded.description.sharing(0)) < recorded.infants:
        which = "choose one for --video with --infant"
        raise MimocError(f"{recorded.path}: {recorded.infants} infants are recorded here; {which}")
    failed = steps = count = 0
    filmed: Any = nullcontext()
    if video and recorded:
        filmed = film_of(video, recorded[0].step_ms, eyes=eyes, height_px=size, body=body.value)
    chosen: dict[str, Any] = {"infant": infant, "episode": episode, "task": import_object(task) if task else None}
    with console.progress("replaying") as show, filmed as film:

        def watch(one: "Infant", observation: Any) -> None:
            film({one.name: one}, {one.name: observation})

        watching: dict[str, Any] = {"watch": watch} if film else {}
        for replayed in recordings.replay_recording(recorded, **chosen, **watching, progress=show):
            count, steps = count + 1, steps + replayed.episode.steps
            if replayed.difference:
                failed += 1
                print(printable(replayed))
    if failed:
        print(f"failed: {failed} of {counted(count, 'episode')} did not come out again")
        raise typer.Exit(FAILED_CHECK)
    print(f"ok: all numbers of {counted(count, 'episode')}, {counted(steps, 'control step')}, came out again")
    if video:
        print(printable(video))


_OURS = [f"{name} ({EXPORTERS[name].about})" for name in EXPORTERS]
FORMATS = f"{', '.join((*_OURS, *announced('mimoc.exporters')))}."


def export(
    recording: RecordingPath,
    to: Annotated[str, typer.Option(metavar="FORMAT", help=FORMATS)],
    out: Annotated[Path, typer.Option("-o", "--out", metavar="OUT", help="Folder to write: a new or empty one.")],
) -> None:
    """Write a recording in the format of others, and say what that cannot hold."""
    from mimoc.cli import console
    from mimoc.recording.exporters import export_recording

    with console.progress("exporting") as show:
        notes = export_recording(recording, to, out, progress=show)
    for note in notes:
        print(printable(f"note: {note}"), file=sys.stderr)
    print(printable(out))


Source = Annotated[
    Path | None,
    typer.Argument(metavar="RECORDING", help="Folder written with --record; or one of several, such as a cohort's."),
]
Names = Annotated[list[str] | None, typer.Argument(metavar="NAME", help="Quantities; by default all that there are.")]


def measure(
    recording: Source = None,
    names: Names = None,
    out: Annotated[
        Path | None, typer.Option("-o", "--out", metavar="FILE.csv", help="Write a row for each episode.")
    ] = None,
    contacts: Annotated[
        Path | None,
        typer.Option(metavar="FILE.csv", help="Write who touches and looks at whom in a world of several infants."),
    ] = None,
    list_: Annotated[bool, typer.Option("--list", help="List all quantities, with unit and definition.")] = False,
) -> None:
    """Measure recorded episodes: paths, speeds and movement units of hands and feet, contacts, returns and others.

    Infants that share a world are beside each other, and a second table says who touches and looks at whom.
    """
    from mimoc.cli import console
    from mimoc.recording.measures import contacts_and_gaze, measurable, measure_recordings

    if list_ and (recording or out or contacts):
        raise MimocError("--list says what can be measured, of no recording; leave out the rest")
    if list_:
        _print_quantities(measurable().values())
        return
    if recording is None:
        raise MimocError("name the folder of a recording, or list what can be measured with --list")
    with console.progress("measuring") as show:
        table = measure_recordings(recording, names or (), progress=show)
        shares_a_world = contacts or (not names and _is_of_a_world(recording))
        between = contacts_and_gaze(recording, progress=show) if shares_a_world else None
    if out:
        _write(out, table)
    if contacts and between:
        _write(contacts, between)
    if out or contacts:
        sys.stdout.writelines(f"{printable(path)}\n" for path in (out, contacts) if path)
        return
    episodes = counted(len(table["episode"]), "episode")
    _print_measured(_by_infant(table, measurable(), together=between is None), episodes)
    if between:
        _print_contacts(between, f"contacts and gaze, {episodes}")


def _is_of_a_world(folder: Path) -> bool:
    from mimoc.recording.description import RECORDING, description_in

    folder = folder.expanduser()
    if not (folder / RECORDING).is_file():
        return False
    description = description_in(folder)
    return 1 < len(description.infants) == len(description.sharing(0))


def _by_infant(table: dict[str, list[Any]], known: Container[str], *, together: bool) -> dict[str, dict[str, Any]]:
    """Return the quantities in a table by the name of the infant, or of all infants together."""
    whose = ["" if together else name for name in table["name"]]
    return {
        who: {
            name: [value for value, owner in zip(values, whose, strict=True) if owner == who]
            for name, values in table.items()
            if name in known
        }
        for who in dict.fromkeys(whose)
    }


def _write(path: Path, table: dict[str, list[Any]]) -> None:
    """Write a table as CSV, whole or not at all; None is an empty cell."""
    from mimoc.bundle.files import write_file

    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerows([table, *zip(*table.values(), strict=True)])
    write_file(path, text.getvalue().encode())


def _print_quantities(quantities: Iterable["Quantity"]) -> None:
    from mimoc.cli.console import print_table

    rows = ((item.name, item.unit, f"{item.label}: {item.about}") for item in quantities)
    print_table(("name", "unit", "what it is"), rows, left=3)


def _print_measured(columns: Mapping[str, Mapping[str, Sequence[float | None]]], title: str) -> None:
    """Print the quantities of episodes, by infant: of several, mean, standard deviation (n - 1), and how many."""
    from mimoc.base.quantities import QUANTITIES
    from mimoc.cli.console import print_table

    values = {
        who: {name: [value for value in column if value is not None] for name, column in of_infant.items()}
        for who, of_infant in columns.items()
    }
    several = any(len(column) > 1 for of_infant in values.values() for column in of_infant.values())
    headings = ("mean", "SD", "n") if several else ("value",)
    if len(values) > 1:
        headings = [f"{who} {heading}" if several else who for who in values for heading in headings]
    rows = (
        (QUANTITIES[name].title, *(cell for of_infant in values.values() for cell in _spread(of_infant[name], several)))
        for name in next(iter(values.values()))
    )
    print_table(("measure", *headings), rows, title=title)


def _spread(values: Sequence[float], several: bool) -> list[str]:
    from statistics import fmean, stdev

    mean = readable(fmean(values)) if values else "-"
    return [mean, readable(stdev(values), 2) if len(values) > 1 else "-", f"{len(values)}"] if several else [mean]


MAX_PARTS = 6  # Pairs of parts that are printed for each pair of infants.


def _print_contacts(table: Mapping[str, Sequence[Any]], title: str) -> None:
    """Print who touches and looks at whom, in all episodes together, and the parts that do so for longest."""
    from mimoc.cli.console import print_table

    keys = [*zip(*(table[name] for name in ("infant", "does", "other", "part", "other_part")), strict=True)]
    seconds, times = dict[tuple[str, ...], float](), dict[tuple[str, ...], int]()
    for key, length_s, count in zip(keys, table["seconds"], table["times"], strict=True):
        seconds[key] = seconds.get(key, 0.0) + length_s
        times[key] = times.get(key, 0) + count
    rows = []
    for whole in (key for key in seconds if key[4] == "any"):
        rows.append((" ".join(whole[:3]), "", "", readable(seconds[whole]), f"{times[whole]}"))
        parts = sorted((key for key in seconds if key[:3] == whole[:3] and key != whole), key=lambda key: -seconds[key])
        for key in parts[:MAX_PARTS]:
            rows.append(("", *(name.replace("_", " ") for name in key[3:]), readable(seconds[key]), f"{times[key]}"))
    print_table(("who", "with", "what", "seconds", "times"), rows, title=title, left=3)
