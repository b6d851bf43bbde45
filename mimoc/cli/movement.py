"""`mimoc movement`."""

from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

import mimoc
from mimoc.base.errors import MimocError
from mimoc.cli.arguments import Beside, load_counterpart
from mimoc.cli.pictures import parse_seeds
from mimoc.cli.points import (
    Infant,
    MinScore,
    Names,
    Picture,
    Rate,
    UpAxis,
    ViewName,
    names_of,
    options_in_messages,
    picture_of,
)
from mimoc.cli.run import POLICY_NAMES
from mimoc.cli.terminal import printable

if TYPE_CHECKING:
    from mimoc.movement.filming import Filmed
    from mimoc.movement.simulated import Progress
    from mimoc.movement.sources import SourceOptions

Source = Annotated[
    Path,
    typer.Argument(
        metavar="RECORDING|RUN|COHORT|INFANT",
        help="Recorded points of a filmed infant; a folder written with --record or by `mimoc retarget`; a folder of "
        "such, or of a cohort whose steps record; or a bundle or a spec, with --policy.",
    ),
]
Against = Annotated[
    str | None, typer.Option(metavar="real|PATH", help="Compare with 12 real infants, or with recordings of your own.")
]
PolicyName = Annotated[
    str | None,
    typer.Option(metavar="NAME", help=f"How a bundle or a spec moves: {POLICY_NAMES}; or a trained policy.zip."),
]
Phase = Annotated[Path | None, typer.Option(metavar="FILE", help="Plot knees over hips, if points are known in space.")]
REAL, FRONT, SEEDS = "real", "front", "0:12"
SIMULATED = "is for an infant that is simulated; name a spec or a bundle, and its --policy, or leave it out"
NO_POINTS = "says how points are read, which mimoc did not write itself, and there are none here; leave it out"
SHOWN = 2
"""Simulated or measured infants that are animated beside one of those they are compared with."""


def movement(
    source: Source,
    against: Against = None,
    policy: PolicyName = None,
    seeds: Annotated[
        str | None, typer.Option(metavar="FIRST:END", help="Its seeds; END is excluded.", show_default=SEEDS)
    ] = None,
    seconds: Annotated[
        float | None, typer.Option(min=2, max=3600, help="How long it moves for each.", show_default="33")
    ] = None,
    rate: Rate = None,
    infant: Infant = None,
    view: ViewName = FRONT,
    name: Names = None,
    min_score: MinScore = None,
    picture: Picture = None,
    up: UpAxis = None,
    beside: Beside = None,
    full: Annotated[bool, typer.Option("--full", help="Print all measures, not only the 21.")] = False,
    json: Annotated[Path | None, typer.Option(metavar="FILE", help="Write all as JSON.")] = None,
    plot: Annotated[Path | None, typer.Option(metavar="FILE", help="Plot the 21 measures: .png, .svg ...")] = None,
    phase: Phase = None,
    gif: Annotated[Path | None, typer.Option(metavar="FILE", help="Animate stick figures: .gif or .mp4.")] = None,
) -> None:
    """Measure how infants move, real or simulated, and compare them with real infants or with others."""
    from mimoc.cli import console
    from mimoc.cli.movement_table import print_movement
    from mimoc.movement import sources
    from mimoc.movement.report import measure_all
    from mimoc.policies.class_policy import class_or_text

    _check_files(json, plot, phase, gif)
    if against and against != REAL and not Path(against).exists():
        raise MimocError(f"{against}: does not exist; compare with `{REAL}`, or name recordings")
    if not policy:
        _refuse({"beside": beside, "seeds": seeds, "seconds": seconds}, SIMULATED)
    if not any(sources.reads_points(path) for path in (source, Path(against or REAL)) if str(path) != REAL):
        of_points = {"rate": rate, "infant": infant, "view": view != FRONT or None, "name": name}
        _refuse({**of_points, "min-score": min_score, "picture": picture, "up": up}, NO_POINTS)
    chosen = mimoc.load_policy(policy) if policy and policy.endswith(".zip") else class_or_text(policy or "") or None
    reading = {"rate_hz": rate, "infant": infant, "view": view, "names": names_of(name), "min_score": min_score}
    reading |= {"picture_px": picture_of(picture), "up": up}
    options = sources.SourceOptions(chosen, parse_seeds(seeds or SEEDS), seconds or sources.SECONDS, reading)
    others = {beside: load_counterpart(source, beside)} if beside else {}
    with console.progress("simulating") as show, options_in_messages():
        films = sources.films_in(source, options, show)
        filmed = {name: sources.films_of(other, options, show) for name, other in others.items()}
    sample = _recordings(against, options) if against and against != REAL else []
    with console.progress("measuring") as show:
        counterparts = {name: measure_all(some, show) for name, some in filmed.items()}
        measured = replace(_measured(films, against, sample, show), beside=counterparts)
    print_movement(measured, full)
    _write(measured, films, sample, (json, plot, phase, gif))


def _refuse(given: dict[str, object], reason: str) -> None:
    for name, value in given.items():
        if value is not None:
            raise MimocError(f"--{name} {reason}")


def _measured(films: "list[Filmed]", against: str | None, others: "list[Filmed]", show: "Progress") -> Any:
    import numpy as np

    from mimoc.movement.real_infants import real_infants
    from mimoc.movement.report import compare, measure_all

    if against is None:
        return measure_all(films, show)
    sample = [film.seen for film in others] or real_infants()
    return compare(films, sample, np.random.default_rng(0), show)


def _recordings(path: str, options: "SourceOptions") -> "list[Filmed]":
    from mimoc.cli import console
    from mimoc.movement import sources

    with console.progress("reading") as show, options_in_messages():
        others = sources.films_in(Path(path), replace(options, policy=None), show)
    if len(others) < 2:
        raise MimocError(f"{path}: one infant is no sample; name a folder with recordings of two or more")
    return others


def _check_files(json: Path | None, plot: Path | None, phase: Path | None, gif: Path | None) -> None:
    """Refuse, before anything takes time, names that no picture can have and folders that do not exist."""
    from mimoc.recording.video import check_video
    from mimoc.render.plots import file

    for path in (plot, phase):
        if path:
            file.check_plot_name(path)
            file.require_matplotlib()
    if gif:
        check_video(gif)
    for path in (json, plot, phase):
        if path and not path.expanduser().parent.is_dir():
            raise MimocError(f"{path}: there is no folder {path.parent}; create it, or choose another file")


def _write(measured: Any, films: "list[Filmed]", others: "list[Filmed]", paths: tuple[Path | None, ...]) -> None:
    from mimoc.base.rounding import render_json
    from mimoc.bundle.files import write_file
    from mimoc.cli import console
    from mimoc.movement.plots import write_measures, write_phases
    from mimoc.movement.stick_figures import MOST, animate

    json, plot, phase, gif = paths
    if phase:
        write_phases(films, phase)  # The only one that may refuse, so the first.
    if json:
        write_file(json, render_json(measured.to_data()))
    if plot:
        write_measures(measured, plot)
    if gif:
        chosen = [film.seen for film in (*others[:SHOWN], *films)][:MOST]
        with console.progress("drawing") as show:
            animate(chosen, gif, columns=min(4, len(chosen)), progress=show)
    for path in paths:
        if path:
            print(printable(path))
