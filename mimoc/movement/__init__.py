"""Measures of spontaneous movement, the same for points on real and on simulated infants."""

from mimoc.movement.measures import core_measures, measure_movement
from mimoc.movement.sample import Sample, distance, standard_scores

__all__ = ["Sample", "core_measures", "distance", "measure_movement", "standard_scores"]
