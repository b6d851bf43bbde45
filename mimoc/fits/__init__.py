"""From anthropometric tables to the measurements of a child of any age."""

from mimoc.fits.anthropometry import Measured as Measured, Measurements as Measurements
from mimoc.fits.growth import Curves as Curves, measure as measure
from mimoc.fits.tables import load_tables as load_tables
