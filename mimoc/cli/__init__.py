"""The `mimoc` command line: its commands by theme."""

from mimoc.cli.entry import main

__all__ = ["main"]
