"""Columns of arrays by name, in which random numbers are handed over."""

from collections.abc import Mapping
from typing import Any


class Columns:
    """The names of the columns of an array of shape (k, width), in their order."""

    def __init__(self, widths: Mapping[str, int]):
        self._slices: dict[str, slice] = {}
        self.width = 0
        """Number of all columns."""
        for name, width in widths.items():
            self._slices[name] = slice(self.width, self.width + width)
            self.width += width

    def split(self, array: Any) -> dict[str, Any]:
        """Return the columns of each name, shape (k, width of the name)."""
        return {name: array[:, columns] for name, columns in self._slices.items()}
