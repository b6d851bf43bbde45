"""What `mimoc validate --against` compares an infant with."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mimoc.render.plots.plot import Sheet
    from mimoc.schema.infant import InfantSpec

Progress = Callable[[int, int], None]
"""Called with the number of steps done and their total number."""


@dataclass(frozen=True, slots=True)
class Findings:
    """Result of a comparison."""

    passed: bool
    data: dict[str, Any]
    """All numbers, for `--json`."""
    show: Callable[[], None]
    """Prints the result for people."""
    sheet: Callable[[], Sheet]
    """Returns the plots of it."""


def _against_who(infant: InfantSpec | None, progress: Progress) -> Findings:
    from mimoc.cli.validation_tables import print_growth
    from mimoc.compiler import validation
    from mimoc.render.plots.growth import growth_sheet

    report = validation.grow_against_who(infant, progress=progress)
    shown = partial(print_growth, report, validation.REQUESTED_SD)
    return Findings(report.passed, report.to_data(), shown, lambda: growth_sheet(report.series, report.reference))


def _against_anthrokids(infant: InfantSpec | None, progress: Progress) -> Findings:
    from mimoc.cli.validation_tables import print_measurements
    from mimoc.compiler.validation import anthrokids
    from mimoc.render.plots.growth import measurements_sheet

    report = anthrokids.compare_with_anthrokids(infant, progress=progress)
    series = {
        name: [(age_months, row.value_cm) for age_months, row in rows.items()] for name, rows in report.by_measurement()
    }
    shown = partial(print_measurements, report, anthrokids.TOLERANCE)
    sheet = partial(measurements_sheet, series, anthrokids.TOLERANCE)
    return Findings(report.within_tolerance, report.to_data(), shown, sheet)


def _against_milestones(infant: InfantSpec | None, progress: Progress, *, delays: bool = False) -> Findings:
    from mimoc.cli.validation_tables import print_milestones
    from mimoc.milestones import Conditions, validate_milestones
    from mimoc.render.plots.milestones import rows_sheet

    processes = os.cpu_count() or 1
    report = validate_milestones(infant, Conditions(delays=delays), processes=processes, progress=progress)
    sheet = partial(rows_sheet, report.rows, "real infants (line: median)", ("window", "reached"))
    return Findings(report.passed, report.to_data(), partial(print_milestones, report), sheet)


VALIDATIONS: Mapping[str, Callable[..., Findings]] = {
    "who": _against_who,
    "anthrokids": _against_anthrokids,
    "milestones": _against_milestones,
}
"""How an infant, or the average child if none is given, is compared, by the name that a user gives."""
