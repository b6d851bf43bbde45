"""Servos that hold a commanded angle."""
