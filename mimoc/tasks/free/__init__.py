"""No goal."""
