"""A crib."""
