"""Measures of spontaneous movement, the same for points on real and on simulated infants."""
