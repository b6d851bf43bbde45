"""The plot of a skill by age, beside the ages of real infants."""

from mimoc.base.quantities import Quantity
from mimoc.base.quantities.child import AGE
from mimoc.render.plots.plot import Band, Dots, Line, Plot, Sheet
from mimoc.studies.skills.learning import LEARNT, SkillReport

SUCCESS = Quantity("success_rate", "Success", "1")


def skill_sheet(report: SkillReport) -> Sheet:
    """Return success by age with its intervals, each search as a dot, over the ages of real infants."""
    ages = [result.age_months for result in report.ages]
    low, high = zip(*(result.interval for result in report.ages), strict=True)
    real = report.real_infants
    window = real.youngest_months, real.oldest_months
    searches = [(result.age_months, attempt.success) for result in report.ages for attempt in result.searches]
    plot = Plot(
        x=AGE,
        y=SUCCESS,
        lines=(
            Line(ages, [result.success for result in report.ages], "all searches"),
            *(Line((age,) * 2, (0.0, 1.0), "", "median") for age in real.ages[1:-1]),
        ),
        bands=(
            Band(
                window,
                (0.0, 0.0),
                (1.0, 1.0),
                "real infants (line: usual)",
                "window",
            ),
            Band(ages, low, high, "95 %"),
        ),
        dots=(Dots([age for age, _ in searches], [share for _, share in searches], "each search"),),
        title=f"{report.skill.replace('_', ' ')}: share of starts with success",
        x_range=(min([*ages, real.youngest_months]) - 0.5, max([*ages, real.oldest_months]) + 0.5),
        y_range=(-0.03, 1.03),
        level=LEARNT,
    )
    return Sheet((plot,))
