"""Delays of the signals between the body and its controller."""
