"""Docstrings as pages: what they indent after an empty line is a program."""

import re

from sphinx.application import Sphinx

INDENTED = re.compile(r" {4}\S")


def setup(app: Sphinx) -> dict[str, bool]:
    """Let Sphinx read docstrings through this module, before it looks for arguments and errors in them."""
    app.connect("autodoc-process-docstring", _mark_programs, priority=100)
    return {"parallel_read_safe": True}


def _mark_programs(app: Sphinx, what: str, name: str, thing: object, options: object, lines: list[str]) -> None:
    """Mark each program in a docstring as one, in place; arguments follow their heading without an empty line."""
    marked: list[str] = []
    above = ""
    for index, line in enumerate(lines):
        if INDENTED.match(line) and index and not lines[index - 1] and above and not above.startswith(" "):
            marked += [".. code-block:: python", ""]
        marked.append(line)
        above = line or above
    lines[:] = marked
