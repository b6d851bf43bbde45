"""Noise of the commands and the senses, and jitter of their delays."""
