"""`mimoc replay` and `mimoc export`: what becomes of recordings."""

import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mimoc.base.errors import MimocError, counted
from mimoc.base.kinds import announced
from mimoc.cli.arguments import Body, RecordingPath, ShownBody, check_video, import_object
from mimoc.cli.terminal import FAILED_CHECK, printable
from mimoc.exporters import EXPORTERS

if TYPE_CHECKING:
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
    eyes: Annotated[bool, typer.Option("--eyes", help="Show the views of both eyes beside the video.")] = False,
    size: Annotated[int, typer.Option(min=64, max=2160, help="Height of the video in pixels.")] = 360,
    body: ShownBody = Body.SKIN,
) -> None:
    """Simulate a recording again, and say whether every number comes out again; exit code 1 if not."""
    from mimoc import recording as videos, recordings
    from mimoc.cli import console
    from mimoc.recording.reading import read_recording

    check_video(video, eyes)
    recorded = read_recording(recording)
    if video and infant is None and len(recorded.description.sharing(0)) < recorded.infants:
        which = "choose one for --video with --infant"
        raise MimocError(f"{recorded.path}: {recorded.infants} infants are recorded here; {which}")
    failed = steps = count = 0
    filmed: Any = nullcontext()
    if video and recorded:
        filmed = videos.film_of(video, recorded[0].step_ms, eyes=eyes, height_px=size, body=body.value)
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
    from mimoc.recording.export import export_recording

    with console.progress("exporting") as show:
        notes = export_recording(recording, to, out, progress=show)
    for note in notes:
        print(printable(f"note: {note}"), file=sys.stderr)
    print(printable(out))
