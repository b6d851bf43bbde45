"""Environments, opened from specs and bundles."""
