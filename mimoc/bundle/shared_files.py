"""Files that several bundles share, as links."""

import os
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path

from mimoc.bundle.files import discard, make_folder, temporary_path
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file


@dataclass(frozen=True, slots=True)
class SharedFiles:
    """A folder of files by digest, on the file system of the bundles that share them."""

    folder: Path

    def put(self, path: Path, content: bytes) -> None:
        """Write a file as a link to the shared one, or as a copy where there are no links.

        Raises:
            OSError: If it cannot be written.
            OutputError: If the folder of the shared one is a link.
        """
        digest = sha256(content).hexdigest()
        shared = self.folder / digest[:2] / digest
        if not self._link(shared, path, content):
            path.write_bytes(content)
            self._share(path, shared)

    def _link(self, shared: Path, path: Path, content: bytes) -> bool:
        """Make a file a link to the shared one, if that has its content; return whether it is one now."""
        try:
            if read_regular_file(shared, below=self.folder) != content:
                return False
            os.link(shared, path, follow_symlinks=False)
        except (OSError, UnusableFileError):  # It has as many links as the file system allows, or there are none.
            return False
        return True

    def _share(self, path: Path, shared: Path) -> None:
        """Let later bundles link to a file, if the file system can."""
        make_folder(shared.parent, below=self.folder)
        temporary = temporary_path(shared)
        try:
            os.link(path, temporary)
            os.replace(temporary, shared)
        except OSError:
            discard(temporary)
