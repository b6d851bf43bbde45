"""Behaviours: parts of what an infant does, which one controller does all at once; see docs/behaviours.md."""
