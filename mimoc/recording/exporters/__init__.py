"""Formats that recordings are exported to."""
