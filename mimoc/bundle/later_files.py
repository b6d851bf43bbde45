"""The files of a bundle that are only made when somebody reads them: an environment needs few of them."""

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property


class LaterFiles(Mapping[str, bytes]):
    """Content by path, read-only."""

    def __init__(self, ready: Mapping[str, bytes], wanted: str, make: Callable[[], Mapping[str, bytes]]):
        """Promise some files.

        Args:
            ready: Files that are there already.
            wanted: Path of a file that is among them, if the bundle has it at all.
            make: Returns all files, those included.
        """
        self._ready, self._wanted, self._make = ready, wanted, make

    def __getitem__(self, path: str) -> bytes:
        """Return the content of a file."""
        return self._ready[path] if path == self._wanted else self._all[path]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    @cached_property
    def _all(self) -> Mapping[str, bytes]:
        return self._make()
