"""`mimoc validate`, and what it compares an infant with."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from mimoc.base.errors import MimocError, UnknownNameError, check_name
from mimoc.cli.arguments import AsJson, Beside, load_spec
from mimoc.cli.terminal import FAILED_CHECK

if TYPE_CHECKING:
    from mimoc.render.plots import Sheet
    from mimoc.schema.infant import InfantSpec

NERVOUS = ("delays", "noise")  # What an infant can be tried without in milestones.

Progress = Callable[[int, int], None]  # Called with the number of steps done and their total number.


@dataclass(frozen=True, slots=True)
class Findings:
    """Result of a comparison."""

    passed: bool
    data: dict[str, Any]
    show: Callable[[], None]
    sheet: Callable[[], Sheet]


def _against_who(infant: InfantSpec | None, progress: Progress) -> Findings:
    from mimoc.cli.tables import print_growth
    from mimoc.studies import growth
    from mimoc.studies.growth_plots import growth_sheet

    report = growth.grow_against_who(infant, progress=progress)
    shown = partial(print_growth, report, growth.REQUESTED_SD)
    return Findings(report.passed, report.to_data(), shown, lambda: growth_sheet(report.series, report.reference))


def _against_anthrokids(infant: InfantSpec | None, progress: Progress) -> Findings:
    from mimoc.cli.tables import print_measurements
    from mimoc.studies import growth
    from mimoc.studies.growth_plots import measurements_sheet

    report = growth.compare_with_anthrokids(infant, progress=progress)
    series = {
        name: [(age_months, row.value_cm) for age_months, row in rows.items()] for name, rows in report.by_measurement()
    }
    shown = partial(print_measurements, report, growth.TOLERANCE)
    sheet = partial(measurements_sheet, series, growth.TOLERANCE)
    return Findings(report.within_tolerance, report.to_data(), shown, sheet)


def _against_milestones(
    infant: InfantSpec | None, progress: Progress, *, without: frozenset[str] = frozenset(), beside: str | None = None
) -> Findings:
    from mimoc.cli.tables import print_milestones
    from mimoc.studies.growth_plots import rows_sheet
    from mimoc.studies.milestones import validate_milestones
    from mimoc.studies.milestones.trial import Conditions

    conditions = Conditions(**{part: part not in without for part in NERVOUS})
    report = validate_milestones(infant, conditions, processes=os.cpu_count() or 1, progress=progress, beside=beside)
    sheet = partial(rows_sheet, report.rows, "real infants (line: usual age)", ("window", "reached"))
    return Findings(report.passed, report.to_data(), partial(print_milestones, report), sheet)


def _against_movement(
    infant: InfantSpec | None,
    progress: Progress,
    *,
    ages: str | None = None,
    trials: str | None = None,
    beside: str | None = None,
) -> Findings:
    from mimoc.cli.tables import print_movement
    from mimoc.components.senses.vision.preview import read_ages
    from mimoc.render.plots import windows_sheet
    from mimoc.studies.movement import USUAL, validate_movement

    names = trials.split(",") if trials else USUAL
    months = read_ages(ages) if ages is not None else None
    report = validate_movement(
        infant, names=names, ages=months, processes=os.cpu_count() or 1, progress=progress, beside=beside
    )
    sheet = partial(windows_sheet, report.panels, "real infants")
    return Findings(report.passed, report.to_data(), partial(print_movement, report), sheet)


def _against_skills(infant: InfantSpec | None, progress: Progress) -> Findings:
    from mimoc.cli.skill import print_skills
    from mimoc.studies.growth_plots import rows_sheet
    from mimoc.studies.skills import shipped_skills

    report = shipped_skills()
    sheet = partial(rows_sheet, report.rows, "real infants (line: usual age)", ("window", "reached"))
    return Findings(report.passed, report.to_data(), partial(print_skills, report, infant), sheet)


VALIDATIONS: Mapping[str, Callable[..., Findings]] = {
    "who": _against_who,
    "anthrokids": _against_anthrokids,
    "milestones": _against_milestones,
    "movement": _against_movement,
    "skills": _against_skills,
}
"""How an infant, or the average child if none is given, is compared, by the name that a user gives."""


_Ages = Annotated[
    str | None,
    typer.Option(metavar="MONTHS", help="Ages of the trials of movement, as in 0,3,6; default: those with figures."),
]
_Trials = Annotated[
    str | None,
    typer.Option(metavar="NAMES", help="Trials of movement, as in kick,roll; default: all but roll, which is slow."),
]


def validate(
    spec: Annotated[
        Path | None,
        typer.Argument(
            metavar="SPEC", help="Spec of the infant, or `-` for standard input; default: the average child."
        ),
    ] = None,
    against: Annotated[str, typer.Option(help=f"What to compare with: {', '.join(VALIDATIONS)}.")] = "who",
    as_json: AsJson = False,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE", help="Plot the comparison: .png, .svg, .pdf, .jpg or .webp.")
    ] = None,
    without: Annotated[
        str | None,
        typer.Option(
            metavar="NAMES",
            help="Milestones without delays or noise of senses and commands; `delays,noise`: of the body alone.",
        ),
    ] = None,
    delays: Annotated[bool, typer.Option("--delays", hidden=True)] = False,
    ages: _Ages = None,
    trials: _Trials = None,
    beside: Beside = None,
) -> None:
    """Compare the infant, grown to 0 to 24 months, with children; exit code 1 if it deviates too much.

    - `who`: length, weight and circumferences by WHO's growth standards for its sex: within 0.01 SD of what the spec
      asks for, and of the average child, within one SD of the mean of boys and girls.
    - `milestones`: the ages from which on it holds up its head, sits, stands and so on, in the windows of real infants;
      with delays and noise of its senses and commands, those of its age if it asks for none.
    - `movement`: how it kicks, swings its shanks, lifts its hands, folds its legs, looks, grips and reaches, in the
      windows of real infants; predictions by which nothing of its law was chosen are listed last.
    - `skills`: from when on the average child has what was searched for, as it comes with mimoc; `mimoc skill` searches
      for another child.
    - `anthrokids`: all measurements of the AnthroKids survey, taken on the compiled body, within 4 % of their means,
      as scaled by the spec.
    """
    from mimoc.cli import console
    from mimoc.render.plots import check_plot_name, write_sheet

    if against not in VALIDATIONS:
        raise UnknownNameError("comparison", against, list(VALIDATIONS))
    options = _options(against, without, delays, ages, trials, beside)
    if plot:
        check_plot_name(plot)
    infant = load_spec(spec) if spec else None
    if infant and against == "who" and not infant.body.size_is_known:
        advice = "give its length, 'body.individual.length_cm', and leave out 'body.size_is_known'"
        raise MimocError(f"{spec}: scale not known, so that no growth standard says anything of it; {advice}")
    with console.progress("growing") as show:
        findings = VALIDATIONS[against](infant, show, **options)
    if plot:
        write_sheet(findings.sheet(), plot)
    if as_json:
        print(json.dumps(findings.data, indent=1))
    else:
        findings.show()
    if not findings.passed:
        raise typer.Exit(FAILED_CHECK)


def _options(
    against: str, without: str | None, delays: bool, ages: str | None, trials: str | None, beside: str | None
) -> dict[str, object]:
    """Return the options that a comparison takes, or raise BadParameter if another is given."""
    if delays:
        raise typer.BadParameter("milestones have delays and noise by default; '--without noise' is delays alone")
    if without is not None and against != "milestones":
        raise typer.BadParameter("only milestones have delays and noise; use it with --against milestones")
    if ages is not None and against != "movement":
        raise typer.BadParameter("only movements are tried at ages of choice; use it with --against movement")
    if trials is not None and against != "movement":
        raise typer.BadParameter("only movement has trials of choice; use it with --against movement")
    if beside is not None and against not in ("milestones", "movement"):
        raise typer.BadParameter("only who tries stands beside another child; use --against milestones or movement")
    if against == "milestones":
        names = without.split(",") if without is not None else []
        for name in names:
            check_name("part of the nervous system", name, NERVOUS)
        return {"without": frozenset(names), "beside": beside}
    if against == "movement":
        return {"ages": ages, "trials": trials, "beside": beside}
    return {}
