"""Console output of what was learnt of a skill, by age."""

from mimoc.cli.console import new_table, open_console
from mimoc.studies.skills.learning import SkillReport


def print_skill(report: SkillReport) -> None:
    """Print success by age, and from when on the infant can, beside real infants."""
    out, real = open_console(), report.real
    table = new_table("age", "success", "95 %", "best search", "tried", "")
    for result in report.results:
        low, high = result.interval
        tried = str(sum(attempt.tried for attempt in result.attempts))
        problem = result.attempts[0].problem
        row = f"{result.age_months:g} months", f"{result.success:.0%}", f"{low:.0%} to {high:.0%}"
        table.add_row(*row, f"{result.best.success:.0%}", tried, problem)
    out.print(table)
    since = "at none of these ages" if report.from_months is None else f"from {report.from_months:.1f} months on"
    out.print(f"{report.skill.replace('_', ' ')}: in half of the starts {since}: {report.verdict}")
    span = f"{real.youngest_months:g} to {real.oldest_months:g}, half of them by {real.median_months:g}"
    out.print(f"real infants: {span} months ({real.source}; {real.certainty})")
