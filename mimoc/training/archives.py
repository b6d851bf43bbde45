"""Policies and checkpoints as archives, of which nothing is unpacked that is larger than it can be."""

import io
import zipfile
from pathlib import Path

from mimoc.bundle.regular_files import UnusableFileError, read_regular_file

MOST_BYTES = 2**29
"""Of an archive, and of all that is unpacked of it; 512 MB. Policies of all senses and both eyes have some 10 MB."""
SMALL_BYTES = 2**24
"""Of a member that may be packed to any degree: descriptions, and statistics of a skin that nothing has touched."""
MOST_RATIO = 20
"""Of a larger member to its packed size: weights of networks are noise, which cannot be packed."""
MOST_MEMBERS = 1000


class Archive:
    """The members of a ZIP archive, each unpacked when it is asked for."""

    def __init__(self, content: bytes):
        """Read the list of members.

        Raises:
            ValueError: If it is no archive, or larger than any policy.
            zipfile.BadZipFile: If it is damaged.
        """
        self._archive = zipfile.ZipFile(io.BytesIO(content))
        self._members = {member.filename: member for member in self._archive.infolist()}
        if len(self._archive.infolist()) > MOST_MEMBERS:
            raise ValueError("an archive of too many members")
        self._left = MOST_BYTES

    def names(self) -> list[str]:
        """Return the names of all members."""
        return list(self._members)

    def read(self, name: str) -> bytes:
        """Return the content of a member.

        Raises:
            ValueError: If it is larger than it can be.
            KeyError: If there is none of this name.
        """
        member = self._members[name]
        if member.file_size > max(SMALL_BYTES, MOST_RATIO * member.compress_size) or member.file_size > self._left:
            raise ValueError(f"{name} is larger than it can be")
        self._left -= member.file_size
        return self._archive.read(member)


def read_archive(path: Path) -> Archive:
    """Return the archive in a file.

    Raises:
        ValueError: If it is not a regular file, or larger than any policy.
        zipfile.BadZipFile: If it is damaged.
    """
    try:
        content = read_regular_file(path, MOST_BYTES)
    except UnusableFileError as error:
        raise ValueError(str(error)) from None
    if content is None:
        raise ValueError("it cannot be read")
    return Archive(content)
