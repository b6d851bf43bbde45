"""`mimoc train` and `mimoc evaluate`: policies that learn, and how well they do."""

import math
import sys
import warnings
from collections.abc import Callable, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mimoc.base.errors import counted
from mimoc.base.rounding import readable
from mimoc.cli.arguments import InfantPath, find_world, import_object, load_infant
from mimoc.cli.run import ChosenPolicies, OwnTask as EvaluatedTask, open_env, policies_by_infant
from mimoc.cli.terminal import printable, resumable

if TYPE_CHECKING:
    from mimoc.training import CurvePoint, Training
    from mimoc.training.curve import DeviceUse

CheckpointEvery = Annotated[
    int | None,
    typer.Option(
        min=1,
        help="Steps between checkpoints: the most that a kill can lose; default: 20480, or an episode, "
        "on a device four, if longer.",
    ),
]
StepsPerEpisode = Annotated[
    int | None,
    typer.Option(min=1, help="Control steps after which an episode is truncated; default: those of the task, or 500."),
]
Assignments = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="NAME=VALUE", help="Set a hyperparameter, as in gamma=0.99; repeatable."),
]
Processes = Annotated[
    bool | None,
    typer.Option(
        "--processes/--one-process",
        help="Run each environment in a process of its own, or one after another; default: all together.",
    ),
]
Threads = Annotated[
    int | None,
    typer.Option(min=1, help="Threads that share the work of all together; default: as many as may be used."),
]
OwnTask = Annotated[
    str | None,
    typer.Option(metavar="MODULE:CLASS", help="Take rewards from a class of your own, in a module of this folder."),
]
Steps = Annotated[int, typer.Option(min=1, help="Control steps to train for, summed over all environments.")]
Force = Annotated[bool, typer.Option("--force", help="Discard the training run in the folder and start over.")]
Grow = Annotated[
    str | None,
    typer.Option(metavar="A:B", help="Let the infant have ages from A to B months over the training, as in 6:12."),
]
Schedule = Annotated[
    str, typer.Option(help="Order of the ages of --grow: grown, adult (only the oldest), reversed or shuffled.")
]
Record = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Record all episodes in this folder (needs `mimoc[record]`).")
]
GrowSteps = Annotated[
    int | None, typer.Option(min=1, help="Control steps that growth takes, summed over all environments; default: all.")
]
Device = Annotated[
    str,
    typer.Option(help="Where the infants live and learn: cpu, cuda:0 (needs `mimoc[gpu]`), or warp:cpu to try that."),
]


def train(
    infant: InfantPath,
    out: Annotated[Path, typer.Option("-o", "--out", metavar="RUN", help="Folder of the training run.")],
    algo: Annotated[str, typer.Option(help="Learning algorithm: ppo or sac.")] = "ppo",
    steps: Steps = 500_000,
    seed: Annotated[int, typer.Option(min=0, help="Random seed; the same seed gives the same result.")] = 0,
    envs: Annotated[int, typer.Option(min=1, max=65536, help="Number of infants that learn side by side.")] = 8,
    steps_per_episode: StepsPerEpisode = None,
    checkpoint_every: CheckpointEvery = None,
    assignments: Assignments = None,
    threads: Threads = None,
    processes: Processes = None,
    task: OwnTask = None,
    grow: Grow = None,
    schedule: Schedule = "grown",
    grow_steps: GrowSteps = None,
    record: Record = None,
    device: Device = "cpu",
    force: Force = False,
) -> None:
    """Train a policy for an infant, or one for all of a world; run the same command again to resume it."""
    from mimoc import training
    from mimoc.training.settings import check_envs, parse

    others: dict[str, Any] = {"grow": grow, "schedule": schedule, "grow_steps": grow_steps, "record": record}
    others |= {"threads": threads, "processes": processes, "force": force, "device": device}
    others |= {"steps_per_episode": steps_per_episode, "checkpoint_every": checkpoint_every}
    check_envs(envs, device)
    bundle: Any = find_world(infant) or load_infant(infant)
    others |= {"hyper": parse(algo, assignments or [], device), "task": import_object(task) if task else None}
    with shown() as show, resumable(out / "policy.zip"):
        others |= {"progress": show.report, "on_row": show.on_row}
        done = training.train(bundle, out, algo=algo, steps=steps, seed=seed, envs=envs, **others)
    print_training(done, out, task)


PACKAGE = Path(__file__).parents[1]
LINES_S, LINES_SHARE = 10.0, 1 / 20
"""Least time between two lines, in seconds and as a share of the time so far: 120 lines in ten hours."""


@contextmanager
def shown() -> Iterator["Lines | _Bar"]:
    """Show a training by a progress bar in terminals, and elsewhere by lines now and then; warnings are a line each."""
    from mimoc.cli import console

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

    def on_row(self, row: "CurvePoint") -> None:
        """Write a line with the first row."""
        first, self._row = self._row is None, row
        if first:
            self._line(self._clock())

    def _line(self, now_s: float) -> None:
        from mimoc.cli.console import duration

        begun_steps, begun_s = self._begun or (self._done, now_s)
        elapsed_s, taken = now_s - begun_s, self._done - begun_steps
        parts = [f"{self._done:,} of {self._total:,} steps"]
        parts += [return_of(self._row)] if self._row else []
        parts += [f"{duration(elapsed_s / taken * (self._total - self._done))} left"] if taken else []
        self._write(", ".join(parts))
        self._due_s = now_s + max(LINES_S, LINES_SHARE * elapsed_s)


class _Bar:
    def __init__(self, show: Callable[..., None]):
        self._show, self._text = show, "training"

    def report(self, done: int, total: int) -> None:
        self._show(done, total, self._text)

    def on_row(self, row: "CurvePoint") -> None:
        self._text = f"training, {return_of(row)}"


def return_of(row: "CurvePoint") -> str:
    """Return the mean return of a row as text: of its unfinished episodes, which is said, if none has ended."""
    if row.episodes:
        return f"mean return {_number(row.episode_return)}"
    return f"mean return so far {_number(row.unfinished_return)} in unfinished episodes"


def print_training(training: "Training", out: Path, task: str | None) -> None:
    """Print the first and the last row of the learning curve with episodes that ended, and what to do with the folder.

    The user's own task, if any, is named in what to do, since the policy may observe it.
    """
    from mimoc.base.quantities import CURVE
    from mimoc.cli import console

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


def _taken(use: "DeviceUse") -> str:
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


Episodes = Annotated[int, typer.Option(min=1, help="Number of episodes; episode i begins with seed + i.")]
FirstSeed = Annotated[int, typer.Option(min=0, help="Random seed of the first episode.")]
SideBySide = Annotated[
    int, typer.Option(min=1, max=1024, help="Episodes that run side by side; the result is the same for any number.")
]
EvaluatedSteps = Annotated[
    int | None,
    typer.Option(min=1, help="Control steps after which an episode ends; default: those of the task or the policy."),
]


def evaluate(
    infant: InfantPath,
    policy: ChosenPolicies = None,
    episodes: Episodes = 10,
    seed: FirstSeed = 0,
    envs: SideBySide = 1,
    steps_per_episode: EvaluatedSteps = None,
    task: EvaluatedTask = None,
) -> None:
    """Run the infants under a policy in episodes with seeds of their own, and print how well they did."""
    from mimoc import make_vec
    from mimoc.bundle.world import WorldBundle
    from mimoc.cli import console
    from mimoc.runtime.batch_env import infants_of
    from mimoc.runtime.quantities import measure
    from mimoc.training.evaluation import evaluate as run_episodes

    shown: Any = find_world(infant) or load_infant(infant)
    side_by_side = min(envs, episodes)
    if side_by_side == 1:
        env: Any = open_env(shown, task)
    else:
        own: dict[str, Any] = {}
        rows = side_by_side * len(shown.infants) if isinstance(shown, WorldBundle) else side_by_side
        if task and isinstance(shown, WorldBundle):
            own = {"tasks": {name: import_object(task) for name in shown.infants}}
        elif task:
            own = {"task": import_object(task)}
        env = make_vec(shown, rows, **own)
    with closing(env), console.progress("evaluating") as show:
        chosen = policies_by_infant(policy, infant, None, infants_of("evaluate", env))
        done = run_episodes(env, chosen, episodes, seed, None, steps_per_episode, progress=show)
    by_infant = done if isinstance(done, dict) else {"": done}
    measured = {name: measure("episode", "run", outcomes) for name, outcomes in by_infant.items()}
    console.print_measures(measured, f"{counted(episodes, 'episode')}, seeds {seed} to {seed + episodes - 1}")
