"""Policies that need no training, behaviours, and control by inverse dynamics."""
