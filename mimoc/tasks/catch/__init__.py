"""Catching a falling ball."""
