"""Files that several bundles have in common, kept once: by hard links, named by digest."""

import os
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from mimoc.bundle.files import discard, temporary_path


@dataclass(frozen=True, slots=True)
class SharedFiles:
    """A folder of files by digest, on the file system of the bundles that share them."""

    folder: Path

    def put(self, path: Path, content: bytes) -> None:
        """Write a file as a link to the shared one, or as a copy where there are no links.

        Raises:
            OSError: If it cannot be written.
        """
        digest = sha256(content).hexdigest()
        shared = self.folder / digest[:2] / digest
        try:
            os.link(shared, path)
        except OSError:  # It is new, it has as many links as the file system allows, or there are none.
            path.write_bytes(content)
            self._share(path, shared)

    def _share(self, path: Path, shared: Path) -> None:
        """Let later bundles link to a file, if the file system can."""
        shared.parent.mkdir(parents=True, exist_ok=True)
        temporary = temporary_path(shared)
        try:
            os.link(path, temporary)
            os.replace(temporary, shared)
        except OSError:
            discard(temporary)
