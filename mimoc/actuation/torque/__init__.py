"""Torque motors."""
