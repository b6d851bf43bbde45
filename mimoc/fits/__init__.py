"""From anthropometric tables to the measurements of a child of any age."""

from mimoc.fits.curves import LogCurve, fit_count_curve, fit_log_curve
from mimoc.fits.growth import BIRTH, Placement, fit_growth, group_age, measure
from mimoc.fits.measurements import Measured, Measurements
from mimoc.fits.tables import GrowthTables, load_tables
from mimoc.fits.who import GrowthStandard

__all__ = [
    "BIRTH",
    "GrowthStandard",
    "GrowthTables",
    "LogCurve",
    "Measured",
    "Measurements",
    "Placement",
    "fit_count_curve",
    "fit_growth",
    "fit_log_curve",
    "group_age",
    "load_tables",
    "measure",
]
