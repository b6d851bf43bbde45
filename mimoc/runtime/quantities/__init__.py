"""Measuring of quantities while an infant acts."""
