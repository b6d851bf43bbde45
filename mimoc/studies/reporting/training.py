"""The page of a training run."""

from collections.abc import Iterator
from math import isfinite
from pathlib import Path
from typing import Any

from mimoc.base.quantities import (
    CURVE,
    LEARNING,
    RETURN,
    SO_FAR,
    SUCCESS,
    TIME_TO_SUCCESS,
    TRAINED,
    UNFINISHED,
    UNFINISHED_RETURN,
    Quantity,
)
from mimoc.bundle.world import WorldBundle
from mimoc.render.drawing import draw_svg
from mimoc.render.plots import Dots, Line, Plot
from mimoc.studies.reporting import page, words
from mimoc.studies.reporting.infant import infant_section, infant_sections, introduce, introduce_world
from mimoc.studies.reporting.page import Cell, Code, Details, Drawings, Section, TextBlock, Tile, Tiles, number, table
from mimoc.training.curve import Curve
from mimoc.training.run_folder import RunFile, read_run_bundle, read_training_run
from mimoc.training.settings import hyperparameters_of

NAMES = {
    "algo": "learning algorithm",
    "steps": "control steps",
    "seed": "random seed",
    "envs": "parallel environments",
    "steps_per_episode": "most control steps of an episode",
    "checkpoint_every": "control steps between checkpoints",
}
TILES = (SUCCESS, TIME_TO_SUCCESS, RETURN)
MAX_DOTTED_ROWS = 60  # Number of rows up to which each is drawn as a dot.
CAPTION = "Means of the episodes that ended since the point before; steps are summed over all parallel environments."
UNFINISHED_NOTE = (
    " Hollow and dotted: so far, of episodes that had not ended then, which cannot be compared with whole ones."
)
NO_CURVE = "The training has not reached its first checkpoint: there is no learning curve yet."


def training_page(folder: Path) -> page.Page:
    """Return the page of a training run; raise a MimocError if its files or its infant are damaged."""
    run, curve = read_training_run(folder)
    bundle = read_run_bundle(folder)
    if isinstance(bundle, WorldBundle):
        of_infants = [infant_section(name, infant) for name, infant in bundle.infants.items()]
        lead, pictures = introduce_world(bundle)
    else:
        of_infants = infant_sections(bundle, with_proportions=False)
        lead, pictures = introduce(bundle)
    done, wanted = curve.steps, run.settings.steps
    state = "It is finished" if done >= wanted else f"{100 * done / wanted:.0f} % of what was asked for"
    return page.Page(
        kind="A training run of mimoc",
        title=f"{words.sentence(words.name(bundle.manifest.name))}, trained with {run.settings.algo.upper()}",
        lead=(f"Trained for {done:,} control steps. {state}.", *lead),
        sections=(_curves(curve), _settings(run), *of_infants),
        pictures=pictures,
    )


def _curves(curve: Curve) -> Section:
    if not curve.rows:
        return Section("curves", "Learning", (TextBlock(NO_CURVE, "note"),))
    known = [item for item in LEARNING if _points(curve, item) or _points(curve, SO_FAR.get(item))]
    drawn = tuple(draw_svg(_plot(curve, quantity)) for quantity in known)
    caption = CAPTION + (UNFINISHED_NOTE if _points(curve, UNFINISHED_RETURN) else "")
    rows = []
    for quantity in CURVE:
        ends = [getattr(row, quantity.curve) for row in curve.ends]
        figures = [f"{value:,}" if isinstance(value, int) else words.figure(value) for value in ends]
        rows.append((Cell(quantity.title), *map(number, figures)))
    blocks = Tiles(tuple(_tiles(curve))), Drawings(drawn, caption, "pair"), table(("", "start", "end"), rows)
    return Section("curves", "Learning", blocks)


def _tiles(curve: Curve) -> Iterator[Tile]:
    first, last = curve.ends
    for quantity in TILES:
        unit, scale = ("%", 100) if quantity is SUCCESS else (quantity.unit, 1)
        before, after = (scale * float(getattr(row, quantity.curve)) for row in (first, last))
        then = f"{words.figure(before)} {unit}".rstrip()
        since = f"; {then} at the start" if isfinite(before) else ""
        value = f"{words.figure(after)} {unit}".rstrip() if isfinite(after) else "none"
        yield Tile(quantity.label, value, f"at the end{since}.")
    if not last.episodes:
        so_far = f"{words.figure(last.unfinished_return)} so far"
        yield Tile(UNFINISHED.label, so_far, f"return of {last.unfinished}; no episode has ended.")


def _plot(curve: Curve, quantity: Quantity) -> Plot:
    known = _points(curve, quantity)
    so_far = _points(curve, SO_FAR.get(quantity))
    last = float(max(curve.steps, 1))
    about = f"{quantity.title} by control steps of training"
    if known:
        about += f", from {words.figure(known[0][1])} to {words.figure(known[-1][1])}"
    lines, dots = [], []
    for points, of_line, of_dots, ending in ((so_far, "leader", "survey", " so far"), (known, "line", "mean", "")):
        steps, values = [x for x, _ in points], [y for _, y in points]
        if len(points) > 1:
            lines.append(Line(steps, values, "", of_line))
        if len(points) <= MAX_DOTTED_ROWS:
            titles = tuple(f"{x:,.0f} steps: {words.figure(y)}{ending}" for x, y in points)
            dots.append(Dots(steps, values, "", of_dots, titles))
    return Plot(
        x=TRAINED,
        y=quantity,
        lines=tuple(lines),
        dots=tuple(dots),
        about=about,
        x_range=(0.0, last),
        x_ticks=[(share * last, f"{share * last:,.0f}") for share in (0.0, 0.5, 1.0)],
    )


def _points(curve: Curve, quantity: Quantity | None) -> list[tuple[float, float]]:
    points = [(float(row.steps), float(getattr(row, quantity.curve))) for row in curve.rows] if quantity else []
    return [point for point in points if isfinite(point[1])]


def _settings(run: RunFile) -> Section:
    settings = run.settings
    known = {name: value for name, value in settings.data().items() if value is not None}
    rows = [(Cell(words.sentence(about)), Cell(_text(known[name]))) for name, about in NAMES.items() if name in known]
    rows += [(Cell(f"Own {name}"), Cell(path, "code")) for name, path in sorted(settings.custom.items())]
    rows += [(Cell(f"Growth: {words.name(name)}"), Cell(_text(value))) for name, value in settings.growth.items()]
    rows += [(Cell(f"Belongs to {words.name(name)}"), Cell(_text(value))) for name, value in (run.origin or {}).items()]
    defaults = {name: _text(item.default) for name, item in hyperparameters_of(settings.algo, settings.device).items()}
    hyper = [
        (Cell(name, "code"), number(_text(value)), number(defaults.get(name, "")))
        for name, value in sorted(settings.hyper.items())
    ]
    sessions = [f"session {index}" for index in range(1, len(run.sessions) + 1)]
    names = sorted({name for session in run.sessions for name in session})
    versions = [[Cell(name), *(Cell(session.get(name, "")) for session in run.sessions)] for name in names]
    blocks = (
        table(("setting", "value"), rows),
        Details("Hyperparameters", (table(("hyperparameter", "value", "default"), hyper),)),
        Details("Versions of the software", (table(("", *sessions), versions),)),
        TextBlock("To train an infant of this bundle in the same way:"),
        Code(run.command),
    )
    return Section("settings", "Settings and versions", blocks)


def _text(value: Any) -> str:
    if isinstance(value, dict):
        return ", ".join(f"{name} {_text(item)}" for name, item in value.items())
    if isinstance(value, (list, tuple)):
        return " to ".join(map(_text, value))
    return f"{value:,}" if isinstance(value, int) else f"{value:g}" if isinstance(value, float) else str(value)
