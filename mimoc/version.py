"""The version of mimoc."""

__version__ = "0.1.0"
