"""Recordings of points on infants who were filmed."""
