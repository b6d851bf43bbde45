"""Comparisons of the compiled infant with what is known of children."""

from mimoc.compiler.validation.anthrokids import MeasurementReport, MeasurementRow, compare_with_anthrokids
from mimoc.compiler.validation.requests import compile_infant
from mimoc.compiler.validation.who import (
    REQUESTED_SD,
    GrowthReport,
    Row,
    compare_with_who,
    grow_against_who,
    measure_compiled,
)

__all__ = [
    "REQUESTED_SD",
    "GrowthReport",
    "MeasurementReport",
    "MeasurementRow",
    "Row",
    "compare_with_anthrokids",
    "compare_with_who",
    "compile_infant",
    "grow_against_who",
    "measure_compiled",
]
