"""Torque on a spring and damper at each joint."""
