"""The `mimoc` command line: one thin module per command."""

from mimoc.cli.entry import main

__all__ = ["main"]
