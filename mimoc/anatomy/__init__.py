"""Anatomy: parts, joints and measures of an infant by name, and reference figures of their sizes."""
