"""A delay line: each item comes out a fixed number of items later."""

from collections import deque
from collections.abc import Iterable
from typing import Generic, TypeVar

Item = TypeVar("Item")


class DelayLine(Generic[Item]):
    """First in, first out, of a fixed length; it knows nothing of what it carries."""

    def __init__(self, length: int, item: Item):
        """Fill the line: *item* comes out *length* times before anything that goes in."""
        self._held = deque([item] * length)

    def shift(self, item: Item) -> Item:
        """Put an item in, and return the oldest."""
        self._held.append(item)
        return self._held.popleft()

    @property
    def held(self) -> list[Item]:
        """All items in the line, the oldest first."""
        return list(self._held)

    @held.setter
    def held(self, items: Iterable[Item]) -> None:
        self._held = deque(items)
