"""Companions: what acts in an infant's world besides the infant."""
