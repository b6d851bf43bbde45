"""`mimoc skill`: at which ages an infant can learn a skill."""

import json
import os
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mimoc.base.errors import MimocError
from mimoc.cli.arguments import load_spec
from mimoc.cli.terminal import printable, resumable
from mimoc.schema.kinds import SKILLS

if TYPE_CHECKING:
    from mimoc.studies.skills import SkillReport, SkillsReport

Ages = Annotated[
    str | None,
    typer.Option(
        metavar="MONTHS",
        help="Ages, as in 3:12 (each month), 2:12:2, or 2,4,6,8; default: around those of real infants.",
    ),
]
Options = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Set a key of the task, as in style=hands_and_knees; repeatable."),
]


Name = Annotated[str, typer.Argument(metavar="NAME", help=f"One of: {', '.join(SKILLS)}.")]
Out = Annotated[
    Path | None, typer.Option("-o", "--out", metavar="DIR", help="Folder of results; default: out/skill_NAME.")
]
Spec = Annotated[
    Path | None, typer.Option(metavar="SPEC", help="The child, grown to each age; default: the average one.")
]
Seeds = Annotated[int, typer.Option(min=1, max=100, help="Searches or trainings at each age.")]
Tries = Annotated[int, typer.Option(min=40, help="Movements that each search tries at most.")]
Starts = Annotated[int, typer.Option(min=1, help="Starts in which the result of each is measured.")]
Device = Annotated[
    str, typer.Option(metavar="DEVICE", help="Train a policy on a device, as cuda:0, instead of searching.")
]
Steps = Annotated[int, typer.Option(min=1, help="Control steps of each training on a device.")]
Envs = Annotated[int, typer.Option(min=1, help="Infants that each training on a device learns from.")]
Processes = Annotated[
    int | None, typer.Option(min=1, help="Searches side by side; default: as many as there are cores.")
]


def skill(
    name: Name,
    ages: Ages = None,
    out: Out = None,
    spec: Spec = None,
    options: Options = None,
    seeds: Seeds = 2,
    tries: Tries = 1600,
    starts: Starts = 20,
    device: Device = "cpu",
    steps: Steps = 5_000_000,
    envs: Envs = 512,
    processes: Processes = None,
) -> None:
    """Let an infant learn a skill at several ages, and show from when on it can, beside real infants.

    At each age and with each seed, a search tries movements of a few phases (the cross-entropy method), or, with
    `--device cuda:0`, a policy is trained; what comes of it is measured in starts that it has not seen, with the noise
    and the delays of the age. The folder gets `results.json`, `success.png`, and the best movement or policy of each
    age, for `mimoc run SPEC --policy skill:FILE.json` or `--policy FILE.zip`. Run the same command again to go on after
    an interruption.
    """
    from mimoc.base.errors import check_name
    from mimoc.cli import console
    from mimoc.studies.skills import REAL_AGES, learn_skill

    check_name("skill", name, SKILLS)
    real = REAL_AGES[name]
    first = max(0, round(real.youngest_months) - 2)
    last = round(real.usual_months or real.oldest_months) + 2
    months = read_months(ages, first, last, 2)
    folder = out or Path("out") / f"skill_{name}"
    child = load_spec(spec) if spec else None
    with console.progress(f"learning to {name.replace('_', ' ')}") as show, resumable():
        report = learn_skill(
            name,
            months,
            folder,
            spec=child,
            options=read_options(options or []),
            seeds=seeds,
            tries=tries,
            starts=starts,
            processes=processes or os.cpu_count() or 1,
            device=device,
            steps=steps,
            envs=envs,
            progress=show,
        )
    _show_skill(report, folder)


def read_months(text: str | None, *usual: int) -> tuple[float, ...]:
    """Return the ages in a text such as `3:12`, `2:12:2` or `2,4.5`; without one, those of a range, ends included."""
    try:
        if text is None or ":" in text:
            first, last, *step = usual if text is None else map(int, text.split(":"))
            months = tuple(map(float, range(first, last + 1, *step)))
        else:
            months = tuple(dict.fromkeys(map(float, text.split(","))))
    except ValueError:
        months = ()
    if not months or not all(0 <= month <= 24 for month in months):
        raise MimocError(f"'{text}' is not a list of ages; give months from 0 to 24, as in 3:12 or 2,4,6,8")
    return months


def read_options(texts: list[str]) -> dict[str, Any]:
    """Return keys of a task from assignments such as `style=belly`, with numbers where they are numbers."""
    options: dict[str, Any] = {}
    for text in texts:
        key, is_assigned, value = text.partition("=")
        if not key or not is_assigned:
            raise MimocError(f"'{text}' is not an assignment; write KEY=VALUE, such as style=hands_and_knees")
        try:
            options[key] = json.loads(value)
        except ValueError:
            options[key] = value
    return options


def _show_skill(report: "SkillReport", folder: Path) -> None:
    """Print a report, and write it into a folder as `results.json` and `success.png`."""
    from mimoc.bundle.files import write_file
    from mimoc.render.plots import write_sheet
    from mimoc.studies.skills import skill_sheet

    text = json.dumps(report.to_data(), indent=1, sort_keys=True)
    write_file(folder / "results.json", f"{text}\n".encode())
    _print_skill(report)
    write_sheet(skill_sheet(report), folder / "success.png")
    print(printable(folder / "success.png"))


def print_skills(report: "SkillsReport", infant: object = None) -> None:
    """Print a row for each skill whose results come with mimoc, the sources, and which skills wait for a GPU."""
    from mimoc.cli.console import print_line, print_table

    ages = sorted({age.age_months for skill in report.skills for age in skill.ages})
    rows = []
    for skill in report.skills:
        success = {age.age_months: f"{age.success:.0%}" for age in skill.ages}
        real = skill.real_infants
        since = "" if skill.from_months is None else f"{skill.from_months:.1f}"
        window = f"{real.youngest_months:g}-{real.oldest_months:g}"
        rows.append((skill.skill, *(success.get(age, "") for age in ages), since, window, skill.verdict))
    print_table(("skill", *(f"{age:g}" for age in ages), "from", "real infants", "verdict"), rows)
    for skill in report.skills:
        print_line(f"{skill.skill}: {skill.real_infants.source} ({skill.real_infants.certainty})")
    if infant is not None:
        print_line("these are of the average child; for another one: mimoc skill NAME --spec SPEC")
    print_line(f"without results yet: {', '.join(report.waiting)}: mimoc skill NAME --device cuda:0")


def _print_skill(report: "SkillReport") -> None:
    from mimoc.cli.console import print_line, print_table

    rows = []
    for result in report.ages:
        low, high = result.interval
        tried = str(sum(attempt.tried for attempt in result.searches))
        row = f"{result.age_months:g} months", f"{result.success:.0%}", f"{low:.0%} to {high:.0%}"
        rows.append((*row, f"{result.best.success:.0%}", tried, result.searches[0].problem))
    print_table(("age", "success", "95 %", "best search", "tried", ""), rows)
    since = "at none of these ages" if report.from_months is None else f"from {report.from_months:.1f} months on"
    print_line(f"{report.skill.replace('_', ' ')}: in half of the starts {since}: {report.verdict}")
    is_searched = all(attempt.movement for result in report.ages for attempt in result.searches)
    if report.from_months is None and is_searched:
        print_line(
            "a search without feedback that finds nothing says little; on a GPU a policy learns: --device cuda:0"
        )
    real = report.real_infants
    usual = f", usually {real.usual_months:g}" if real.usual_months is not None else ""
    span = f"{real.youngest_months:g} to {real.oldest_months:g}{usual} months: {real.span}"
    print_line(f"real infants: {span} ({real.source}; {real.certainty})")
