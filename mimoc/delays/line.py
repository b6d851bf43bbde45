"""Delay: what goes in comes out later."""

from collections import deque
from collections.abc import Iterable
from typing import Generic, TypeVar

Item = TypeVar("Item")


class DelayLine(Generic[Item]):
    """First in, first out, always as full as at the start; it knows nothing of what it carries."""

    def __init__(self, length: int, item: Item):
        """Fill a line: *item* comes out *length* times before what goes in does."""
        self._held = deque([item] * length)

    def shift(self, item: Item) -> Item:
        """Put an item in, and take the oldest out."""
        self._held.append(item)
        return self._held.popleft()

    @property
    def held(self) -> list[Item]:
        """What is on its way, the oldest first."""
        return list(self._held)

    @held.setter
    def held(self, items: Iterable[Item]) -> None:
        self._held = deque(items)
