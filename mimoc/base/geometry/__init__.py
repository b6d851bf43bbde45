"""Rotations and primitive solids, in NumPy alone."""
