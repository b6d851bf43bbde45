"""What was learnt of a skill, by age: on the console, as JSON, and as a picture."""

import json
from pathlib import Path

from mimoc.bundle.files import write_file
from mimoc.cli.console import new_table, open_console
from mimoc.cli.terminal import printable
from mimoc.render.plots.file import write_sheet
from mimoc.studies.skills.learning import SkillReport
from mimoc.studies.skills.shipped import SkillsReport, skill_sheet


def show_skill(report: SkillReport, folder: Path) -> None:
    """Print a report, and write it into a folder as `results.json` and `success.png`."""
    text = json.dumps(report.to_data(), indent=1, sort_keys=True)
    write_file(folder / "results.json", f"{text}\n".encode())
    print_skill(report)
    write_sheet(skill_sheet(report), folder / "success.png")
    print(printable(folder / "success.png"))


def print_skills(report: SkillsReport, infant: object = None) -> None:
    """Print a row for each skill whose results come with mimoc, the sources, and which skills wait for a GPU."""
    out = open_console()
    ages = sorted({age.age_months for skill in report.skills for age in skill.ages})
    table = new_table("skill", *(f"{age:g}" for age in ages), "from", "real infants", "verdict")
    for skill in report.skills:
        success, real = {age.age_months: f"{age.success:.0%}" for age in skill.ages}, skill.real_infants
        since = "" if skill.from_months is None else f"{skill.from_months:.1f}"
        window = f"{real.youngest_months:g}-{real.oldest_months:g}"
        table.add_row(skill.skill, *(success.get(age, "") for age in ages), since, window, skill.verdict)
    out.print(table)
    for skill in report.skills:
        out.print(f"{skill.skill}: {skill.real_infants.source} ({skill.real_infants.certainty})")
    if infant is not None:
        out.print("these are of the average child; for another one: mimoc skill NAME --spec SPEC")
    out.print(f"without results yet: {', '.join(report.waiting)}: mimoc skill NAME --device cuda:0")


def print_skill(report: SkillReport) -> None:
    """Print success by age, and from when on the infant can, beside real infants."""
    out, real = open_console(), report.real_infants
    table = new_table("age", "success", "95 %", "best search", "tried", "")
    for result in report.ages:
        low, high = result.interval
        tried = str(sum(attempt.tried for attempt in result.searches))
        problem = result.searches[0].problem
        row = f"{result.age_months:g} months", f"{result.success:.0%}", f"{low:.0%} to {high:.0%}"
        table.add_row(*row, f"{result.best.success:.0%}", tried, problem)
    out.print(table)
    since = "at none of these ages" if report.from_months is None else f"from {report.from_months:.1f} months on"
    out.print(f"{report.skill.replace('_', ' ')}: in half of the starts {since}: {report.verdict}")
    is_searched = all(attempt.movement for result in report.ages for attempt in result.searches)
    if report.from_months is None and is_searched:
        out.print("a search without feedback that finds nothing says little; on a GPU a policy learns: --device cuda:0")
    usual = f", usually {real.usual_months:g}" if real.usual_months is not None else ""
    span = f"{real.youngest_months:g} to {real.oldest_months:g}{usual} months: {real.span}"
    out.print(f"real infants: {span} ({real.source}; {real.certainty})")
