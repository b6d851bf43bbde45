"""Servos that hold a commanded angle with the strength of muscles."""
