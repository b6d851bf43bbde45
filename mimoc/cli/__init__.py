"""The `mimoc` command: thin commands over the library, one module each."""

from mimoc.cli.commands import app
from mimoc.cli.entry import main

__all__ = ["app", "main"]
