"""`mimoc bench`."""

from pathlib import Path
from typing import Annotated

import typer

from mimoc.base.errors import MimocError, counted
from mimoc.base.rounding import readable
from mimoc.cli.run import POLICIES_HELP
from mimoc.cli.terminal import FAILED_CHECK, printable, resumable

PolicyName = Annotated[
    str | None,
    typer.Option(
        metavar="POLICY",
        help=f"What is entered: {POLICIES_HELP} In all of these {{task}} and {{age}} stand for those of each infant.",
    ),
]
Out = Annotated[Path | None, typer.Option("-o", "--out", metavar="FILE", help="Results to write: .json.")]
Names = Annotated[str | None, typer.Option(metavar="NAMES", help="Only these tasks, as in reach,grasp.")]
Months = Annotated[str | None, typer.Option(metavar="MONTHS", help="Only these ages, as in 6,9.")]
Episodes = Annotated[
    int | None,
    typer.Option(min=1, max=100_000, help="Episodes of each task at each age, for a trial run; default: all of them."),
]
Processes = Annotated[
    int | None, typer.Option(min=1, max=1024, help="Processes that share the work; default: one for each core.")
]
Verify = Annotated[
    Path | None,
    typer.Option(
        metavar="FILE",
        help="Score such results again; exit code 1 if a bit is different. A policy that is not below this folder is "
        "only used if you name it, too, with --policy.",
    ),
]
Tables = Annotated[
    list[Path] | None,
    typer.Option("--table", metavar="FILE", help="Print such results as tables in Markdown; repeatable."),
]
Specs = Annotated[
    Path | None, typer.Option(metavar="DIR", help="Write the specs of the infants, to train for them: reach_9.yaml ...")
]
BabyBench = Annotated[
    str | None,
    typer.Option(metavar="BEHAVIOUR", help="Score a behaviour of BabyBench instead: self_touch or hand_regard."),
]


def bench(
    policy: PolicyName = None,
    out: Out = None,
    tasks: Names = None,
    ages: Months = None,
    episodes: Episodes = None,
    processes: Processes = None,
    list_tasks: Annotated[bool, typer.Option("--list", help="Print tasks, ages and seeds.")] = False,
    specs: Specs = None,
    verify: Verify = None,
    table: Tables = None,
    babybench: BabyBench = None,
) -> None:
    """Score a policy in eight tasks at four ages each, with fixed infants and seeds, so that scores can be compared.

    Train with seeds below 1,000,000; those of the test begin there. Run the same command again to go on after an
    interruption. Scores are success with its 95 % interval, return, effort, smoothness, and likeness to real infants;
    docs/benchmark.md defines them and says how to enter.
    """
    _check_mode(policy=None if verify else policy, list=list_tasks, specs=specs, verify=verify, table=table)
    if verify and (out or episodes or babybench):
        raise MimocError("--out, --episodes and --babybench are not for --verify; leave them out")
    if not policy and (out or episodes or babybench):
        raise MimocError("--out, --episodes and --babybench are for a --policy that is entered; leave them out")
    if list_tasks:
        _print_tasks()
    elif specs:
        from mimoc.studies.bench import write_specs

        for path in write_specs(specs, _names(tasks), _months(ages)):
            print(printable(path))
    elif table:
        from mimoc.studies.bench.scores import markdown_tables, read_results

        print(printable(markdown_tables([read_results(path) for path in table])))
    elif verify:
        _verify(verify, tasks, ages, processes, policy)
    elif out is None:
        raise MimocError("name the file of the results with -o FILE.json")
    elif babybench and (tasks or ages or processes):
        raise MimocError("--babybench has one infant and one process; leave out --tasks, --ages and --processes")
    elif babybench:
        _babybench(babybench, policy or "", out, episodes)
    else:
        _enter(policy or "", out, tasks, ages, episodes, processes)


def _check_mode(**modes: object) -> None:
    chosen = [f"--{name}" for name, value in modes.items() if value]
    if not chosen:
        raise MimocError("say what to score: --policy NAME -o FILE.json; or see the tasks with --list")
    if len(chosen) > 1:
        raise MimocError(f"{' and '.join(chosen)} do different things; choose one")


def _enter(
    policy: str, out: Path, tasks: str | None, ages: str | None, episodes: int | None, processes: int | None
) -> None:
    from mimoc.cli import console
    from mimoc.studies.bench import run_bench

    chosen = {"tasks": _names(tasks), "ages_months": _months(ages), "processes": processes or _cores()}
    with console.progress("scoring") as show, resumable():
        results = run_bench(policy, out, **chosen, episodes=episodes, progress=show)
    headings = ("task", "months", "success", "95 %", "return", "effort", "arc length", "jerk", "likeness")
    rows = []
    for cell, scores in results.scored.items():
        interval = "-".join(f"{end:.2f}" for end in scores.success_95 or ())
        means = (scores.mean_return, scores.effort, scores.arc_length, scores.jerk, scores.likeness)
        numbers = ["" if value is None else readable(value) for value in (scores.success, *means)]
        rows.append((cell.task, f"{cell.age_months:g}", numbers[0], interval, *numbers[1:]))
    console.print_table(headings, rows, title=printable(f"{results.policy} in {results.benchmark}"))
    print(printable(out))


def _verify(path: Path, tasks: str | None, ages: str | None, processes: int | None, policy: str | None) -> None:
    from mimoc.cli import console
    from mimoc.studies.bench import verify_bench

    chosen = {"tasks": _names(tasks), "ages_months": _months(ages), "processes": processes or _cores()}
    with console.progress("scoring again") as show:
        compared = verify_bench(path, **chosen, progress=show, policy=policy)
    different = {cell: texts for cell, texts in compared.items() if texts}
    for cell, texts in different.items():
        print(printable(f"{cell}: differs in {'; '.join(texts)}"))
    same = len(compared) - len(different)
    print(printable(f"{path}: the same to the bit for {same} of {counted(len(compared), 'infant')}"))
    if different:
        raise typer.Exit(FAILED_CHECK)


def _babybench(behaviour: str, policy: str, out: Path, episodes: int | None) -> None:
    from mimoc.cli import console
    from mimoc.studies.bench import babybench

    with console.progress(behaviour) as show:
        count = episodes or babybench.EPISODES
        results = babybench.run_babybench(behaviour, policy, out, count, progress=show)
    print(f"{behaviour}: {readable(results.score, 4)} in {counted(count, 'episode')}, by BabyBench's formula")
    if results.in_sight is not None:
        print(f"{behaviour}: {readable(results.in_sight, 4)} by where the eyes' cameras look")
    print(printable(out))


def _print_tasks() -> None:
    from mimoc.cli import console
    from mimoc.studies.bench.table import bench_table

    benchmark = bench_table()
    rows = (
        (name, ", ".join(f"{age:g}" for age in task.ages_months), str(task.episodes or benchmark.episodes), task.about)
        for name, task in benchmark.tasks.items()
    )
    console.print_table(("task", "months", "episodes", "what to do"), rows, title=benchmark.benchmark, left=4)
    for what, (first, end) in (("practice", benchmark.seeds.practice), ("test", benchmark.seeds.test)):
        console.print_line(f"{what} seeds: {first} to {end - 1}")


def _names(text: str | None) -> list[str] | None:
    return None if text is None else [name.strip() for name in text.split(",")]


def _months(text: str | None) -> list[float] | None:
    from mimoc.components.senses.vision.preview import read_ages

    return None if text is None else list(read_ages(text))


def _cores() -> int:
    from mimoc.runtime.batch import usable_threads

    return usable_threads()
