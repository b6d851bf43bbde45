"""The ages at which conduction times are given."""

AGES_MONTHS = (0.0, 1.0, 3.0, 6.0, 12.0, 24.0)
