"""Delays of an infant's signals, from their presets."""
