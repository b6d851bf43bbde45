"""Delays of the signals between the body and its controller."""

AGES_MONTHS = (0.0, 1.0, 3.0, 6.0, 12.0, 24.0)
"""The ages at which conduction times are given."""
