"""Folders that stand for an infant and are no bundle."""

from mimoc.base.kinds import Code

RECORDING: Code = "mimoc.recording.folder"
"""`read_infant(path) -> Bundle`: what a recording is of, or the module that has it."""
