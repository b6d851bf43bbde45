"""The page of a training run."""

from collections.abc import Iterator, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from mimoc.bundle.model import load_model
from mimoc.reporting import words
from mimoc.reporting.drawing import Drawing, dot
from mimoc.reporting.frame import Frame, around
from mimoc.reporting.infant import infant_sections
from mimoc.reporting.infant.portrait import picture
from mimoc.reporting.infant.sources import Sources
from mimoc.reporting.infant.who import described
from mimoc.reporting.page import Block, Cell, Code, Details, Drawings, Page, Section, Text, Tile, Tiles, number, table
from mimoc.training.curve import Curve
from mimoc.training.hyperparameters import HYPERPARAMETERS
from mimoc.training.run_folder import TrainingRun, read_run_bundle, read_training_run
from mimoc.training.settings import Settings
from mimoc.version import __version__

PLOTS = {
    "success_rate": "Share of episodes that succeed",
    "time_to_success_s": "Time to success [s]",
    "episode_return": "Return of an episode",
    "episode_steps": "Length of an episode [control steps]",
}
"""What is drawn of a learning curve, by column."""
NAMES = {
    "algo": "learning algorithm",
    "steps": "control steps",
    "seed": "random seed",
    "envs": "parallel environments",
    "checkpoint_every": "control steps between checkpoints",
}
SHOWN_DOTS = 60
"""Rows up to which each is a dot."""
CAPTION = "Means of the episodes that ended between two checkpoints; steps are summed over all parallel environments."
NO_CURVE = "The training has not reached its first checkpoint: there is no learning curve yet."


def training_page(folder: Path) -> Page:
    """Return the page of a training run.

    Raises:
        TrainingError: If its files are damaged.
        BundleError: If its infant is damaged.
        ModelError: If MuJoCo rejects its model.
    """
    run = read_training_run(folder)
    bundle = read_run_bundle(folder)
    sources = Sources(bundle)
    size, body, senses = infant_sections(bundle, load_model(bundle), sources)
    pictures, missing = picture(bundle)
    return Page(
        kind="A training run of mimoc",
        title=f"{words.sentence(words.name(bundle.manifest.name))}, trained with {run.settings.algo.upper()}",
        lead=(_summary(run), *described(bundle), *([missing] if missing else [])),
        sections=(_curves(run.curve), _settings(run), size, body, senses, sources.section()),
        made_by=f"Made by mimoc {__version__}.",
        pictures=pictures,
    )


def _summary(run: TrainingRun) -> str:
    done, wanted = run.curve.steps, run.settings.steps
    state = "It is finished" if done >= wanted else f"{100 * done / wanted:.0f} % of what was asked for"
    return f"Trained for {done:,} control steps. {state}."


def _curves(curve: Curve) -> Section:
    if not curve.rows:
        return Section("curves", "Learning", (Text(NO_CURVE, "note"),))
    drawn = tuple(_plot(curve, column, title) for column, title in PLOTS.items())
    headings = ("", "first checkpoint", "last checkpoint")
    first, last = curve.rows[0], curve.rows[-1]
    rows = [
        (Cell(title), *(number(words.figure(float(getattr(row, column)))) for row in (first, last)))
        for column, title in {"steps": "Steps trained", "episodes": "Episodes since the one before", **PLOTS}.items()
    ]
    tiles = Tiles(tuple(_tiles(curve)))
    return Section("curves", "Learning", (tiles, Drawings(drawn, CAPTION, "pair"), table(headings, rows)))


def _tiles(curve: Curve) -> Iterator[Tile]:
    first, last = curve.rows[0], curve.rows[-1]
    for column, name, unit in (
        ("success_rate", "Success", "%"),
        ("time_to_success_s", "Time to success", "s"),
        ("episode_return", "Return of an episode", ""),
    ):
        scale = 100 if unit == "%" else 1
        before, after = (scale * float(getattr(row, column)) for row in (first, last))
        told = f"{words.figure(before)} {unit}".rstrip()
        since = f"; {told} at the first" if isfinite(before) else ""
        value = f"{words.figure(after)} {unit}".rstrip() if isfinite(after) else "none"
        yield Tile(name, value, f"at the last checkpoint{since}.")


def _plot(curve: Curve, column: str, title: str) -> Drawing:
    points = [(float(row.steps), float(getattr(row, column))) for row in curve.rows]
    known = [point for point in points if isfinite(point[1])]
    y = (0.0, 1.0) if column == "success_rate" else around((value for _, value in known), _floor(column))
    frame = Frame((0.0, float(max(curve.steps, 1))), y)
    paths = [frame.line(known, "line")] if len(known) > 1 else []
    shown = known if len(known) <= SHOWN_DOTS else []
    dots = [dot(frame.at(*each), "mean", 2.6, f"{each[0]:,.0f} steps: {words.figure(each[1])}") for each in shown]
    about = f"{title} by control steps of training"
    if known:
        about += f", from {words.figure(known[0][1])} to {words.figure(known[-1][1])}"
    return frame.draw(title, "control steps of training", paths, dots, x_ticks=_few(frame.x[1]), description=about)


def _few(steps: float) -> Sequence[tuple[float, str]]:
    return [(share * steps, f"{share * steps:,.0f}") for share in (0.0, 0.5, 1.0)]


def _floor(column: str) -> float | None:
    return None if column == "episode_return" else 0.0


def _settings(run: TrainingRun) -> Section:
    settings = run.settings
    rows = [(Cell(words.sentence(about)), Cell(_text(getattr(settings, name)))) for name, about in NAMES.items()]
    rows += [(Cell(f"Own {name}"), Cell(path, "code")) for name, path in sorted(settings.custom.items())]
    rows += [(Cell(f"Growth: {words.name(name)}"), Cell(_text(value))) for name, value in settings.growth.items()]
    rows += [(Cell(f"Belongs to {words.name(name)}"), Cell(_text(value))) for name, value in run.origin.items()]
    blocks: list[Block] = [
        table(("setting", "value"), rows),
        Details("Hyperparameters", (table(("hyperparameter", "value", "default"), _hyper_rows(settings)),)),
        Details("Versions of the software", (_versions(run),)),
        Text("To train an infant of this bundle in the same way:"),
        Code(run.command),
    ]
    return Section("settings", "Settings and versions", tuple(blocks))


def _hyper_rows(settings: Settings) -> Iterator[tuple[Cell, ...]]:
    defaults = HYPERPARAMETERS.get(settings.algo, {})
    for name, value in sorted(settings.hyper.items()):
        default = _text(defaults[name].default) if name in defaults else ""
        yield Cell(name, "code"), number(_text(value)), number(default)


def _versions(run: TrainingRun) -> Block:
    names = sorted({name for session in run.sessions for name in session})
    headings = ("", *(f"session {index}" for index in range(1, len(run.sessions) + 1)))
    return table(headings, ((Cell(name), *(Cell(each.get(name, "")) for each in run.sessions)) for name in names))


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_text(item)}" for name, item in value.items())
    if isinstance(value, (list, tuple)):
        return " to ".join(map(_text, value))
    return f"{value:,}" if isinstance(value, int) else f"{value:g}" if isinstance(value, float) else str(value)
