"""Touching a ball within reach."""
