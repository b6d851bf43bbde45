"""Turning over."""
