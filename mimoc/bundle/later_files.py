"""The files of a bundle that are only made when somebody reads them: an environment needs few of them."""

from collections.abc import Callable, Iterator, Mapping
from functools import cached_property

from mimoc.bundle.arrays import Array


class LaterFiles(Mapping[str, bytes]):
    """Content by path, read-only."""

    def __init__(self, arrays: Mapping[str, Array], make: Callable[[], Mapping[str, bytes]]):
        """Promise some files.

        Args:
            arrays: What the file of the large arrays holds, read-only, rounded as it is in the file.
            make: Returns all files.
        """
        self.arrays, self._make = arrays, make

    def __getitem__(self, path: str) -> bytes:
        """Return the content of a file."""
        return self._all[path]

    def __iter__(self) -> Iterator[str]:
        return iter(self._all)

    def __len__(self) -> int:
        return len(self._all)

    @cached_property
    def _all(self) -> Mapping[str, bytes]:
        return self._make()
