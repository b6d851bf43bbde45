"""What `mimoc train` prints: how far it is, how well it learns, and what came out."""

import math
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from time import perf_counter
from typing import Any

from mimoc.base.quantities.outcome import CURVE
from mimoc.base.rounding import readable
from mimoc.cli import console
from mimoc.cli.terminal import printable
from mimoc.training import CurvePoint, Training
from mimoc.training.curve import DeviceUse

PACKAGE = Path(__file__).parents[1]
LINES_S, LINES_SHARE = 10.0, 1 / 20
"""Least time between two lines, in seconds and as a share of the time so far: 120 lines in ten hours."""


@contextmanager
def shown() -> Iterator["Lines | _Bar"]:
    """Show a training by a progress bar in terminals, and elsewhere by lines now and then; warnings are a line each."""
    in_terminal = sys.stderr.isatty()  # Which a bar replaces by something that is no terminal.
    with console.progress("training") as bar, _warnings_as_lines():
        yield _Bar(bar) if in_terminal else Lines(_print)


class Lines:
    """Writes a line with the first row of the learning curve, and then now and then."""

    def __init__(self, write: Callable[[str], None], clock: Callable[[], float] = perf_counter):
        self._write, self._clock = write, clock
        self._begun: tuple[int, float] | None = None
        """Steps and time at the first report; a training that is resumed begins with those before."""
        self._done = self._total = 0
        self._row: CurvePoint | None = None
        self._due_s = math.inf

    def report(self, done: int, total: int) -> None:
        """Write a line if it is due."""
        now_s = self._clock()
        if self._begun is None:
            self._begun, self._due_s = (done, now_s), now_s + LINES_S
        self._done, self._total = done, total
        if now_s >= self._due_s:
            self._line(now_s)

    def on_row(self, row: CurvePoint) -> None:
        """Write a line with the first row."""
        first, self._row = self._row is None, row
        if first:
            self._line(self._clock())

    def _line(self, now_s: float) -> None:
        begun_steps, begun_s = self._begun or (self._done, now_s)
        elapsed_s, taken = now_s - begun_s, self._done - begun_steps
        parts = [f"{self._done:,} of {self._total:,} steps"]
        parts += [return_of(self._row)] if self._row else []
        parts += [f"{console.duration(elapsed_s / taken * (self._total - self._done))} left"] if taken else []
        self._write(", ".join(parts))
        self._due_s = now_s + max(LINES_S, LINES_SHARE * elapsed_s)


class _Bar:
    def __init__(self, show: Callable[..., None]):
        self._show, self._text = show, "training"

    def report(self, done: int, total: int) -> None:
        self._show(done, total, self._text)

    def on_row(self, row: CurvePoint) -> None:
        self._text = f"training, {return_of(row)}"


def return_of(row: CurvePoint) -> str:
    """Return the mean return of a row as text: of its unfinished episodes, which is said, if none has ended."""
    if row.episodes:
        return f"mean return {_number(row.episode_return)}"
    return f"mean return so far {_number(row.unfinished_return)} in unfinished episodes"


def print_training(training: Training, out: Path, task: str | None) -> None:
    """Print the first and the last row of the learning curve with episodes that ended, and what to do with the folder.

    The user's own task, if any, is named in what to do, since the policy may observe it.
    """
    rows = training.curve.ends
    title = f"trained for {training.curve.steps} control steps"
    cells = ((quantity.title, *(_number(getattr(row, quantity.curve)) for row in rows)) for quantity in CURVE)
    console.print_table(("quantity", "start", "end"), cells, title=title)
    resumed = f", resumed at step {training.resumed_at}" if training.resumed_at else ""
    console.print_line(f"{training.curve.rows[-1].wall_s:.0f} s of training{resumed}")
    if training.use:
        console.print_line(_taken(training.use))
    option = f" --task {task}" if task else ""
    tried = f"see {out / 'curve.png'}, or try: mimoc run {out / 'bundle'} --policy {training.policy}{option}"
    print(printable(f"{out}: {tried}"))


def _taken(use: DeviceUse) -> str:
    memory = f", {use.memory_mb:,.0f} MB of its memory" if use.memory_mb is not None else ""
    speed = f"{use.control_steps_per_s:,.0f} control steps/s, {use.physics_steps_per_s:,.0f} physics steps/s"
    does = f"without exploring it succeeds in {use.success:.0%} of its infants"
    return f"on {use.device}: {speed}{memory}; {use.overflowed} episodes cut where contacts did not fit; {does}"


@contextmanager
def _warnings_as_lines() -> Iterator[None]:
    def show(message: Warning | str, category: type[Warning], filename: str, *rest: Any) -> None:
        if not Path(filename).is_relative_to(PACKAGE):
            usual(message, category, filename, *rest)
        else:
            _print(f"{'warning' if issubclass(category, RuntimeWarning) else 'note'}: {message}")

    with warnings.catch_warnings():
        usual, warnings.showwarning = warnings.showwarning, show
        warnings.filterwarnings("default", module=r"mimoc\.")
        yield


def _print(line: str) -> None:
    print(printable(line), file=sys.stderr, flush=True)


def _number(value: float) -> str:
    return f"{value}" if isinstance(value, int) else readable(value, 4)
