"""What `mimoc validate --against` compares an infant with."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
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
    plot: Callable[[Path], None]
    """Writes a plot, in the format of the file's name."""


def _against_who(infant: InfantSpec | None, progress: Progress) -> Findings:
    from mimoc.cli.growth_table import print_growth
    from mimoc.compiler import validation
    from mimoc.render.plots import plot_growth

    report = validation.grow_against_who(infant, progress=progress)
    shown = partial(print_growth, report, validation.REQUESTED_SD)
    plot = partial(plot_growth, report.series, reference=report.reference)
    return Findings(report.passed, report.to_data(), shown, plot)


def _against_anthrokids(infant: InfantSpec | None, progress: Progress) -> Findings:
    from mimoc.cli.measurement_table import print_measurements
    from mimoc.compiler.validation import anthrokids
    from mimoc.render.plots.measurements import plot_measurements

    report = anthrokids.compare_with_anthrokids(infant, progress=progress)
    series = {
        name: [(age_months, row.value_cm) for age_months, row in rows.items()] for name, rows in report.by_measurement()
    }
    shown = partial(print_measurements, report, anthrokids.TOLERANCE)
    plot = partial(plot_measurements, series, anthrokids.TOLERANCE)
    return Findings(report.within_tolerance, report.to_data(), shown, plot)


def _against_milestones(infant: InfantSpec | None, progress: Progress, *, delays: bool = False) -> Findings:
    from mimoc.cli.milestone_table import print_milestones
    from mimoc.milestones import Conditions, validate_milestones
    from mimoc.render.plots.milestones import plot_milestones

    processes = os.cpu_count() or 1
    report = validate_milestones(infant, Conditions(delays=delays), processes=processes, progress=progress)
    return Findings(
        report.passed, report.to_data(), partial(print_milestones, report), partial(plot_milestones, report.bars)
    )


VALIDATIONS: Mapping[str, Callable[..., Findings]] = {
    "who": _against_who,
    "anthrokids": _against_anthrokids,
    "milestones": _against_milestones,
}
"""How an infant, or the average child if none is given, is compared, by the name that a user gives."""
