"""Touching a part of one's own body."""
