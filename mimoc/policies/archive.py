"""Archives of strangers: of them nothing is unpacked that is larger than it can be."""

import io
import zipfile
import zlib

from mimoc.base.errors import MimocError
from mimoc.bundle.regular_files import UnusableFileError

MOST_BYTES = 2**29
"""Of an archive, and of all that is unpacked of it; 512 MB. Policies of all senses and both eyes have some 10 MB."""
SMALL_BYTES = 2**24
"""Of a member that may be packed to any degree: descriptions, and statistics of a skin that nothing has touched."""
MOST_RATIO = 20
"""Of a larger member to its packed size: weights of networks are noise, which cannot be packed."""
MOST_MEMBERS = 1000


class Archive(zipfile.ZipFile):
    """A ZIP archive of which each member is unpacked when it is asked for."""

    def __init__(self, content: bytes):
        """Read the list of members; raise a ValueError or BadZipFile if it is no archive, or larger than any policy."""
        super().__init__(io.BytesIO(content))
        if len(self.infolist()) > MOST_MEMBERS:
            raise ValueError("an archive of too many members")
        self._left = MOST_BYTES

    def content(self, name: str) -> bytes:
        """Return the content of a member; raise a KeyError if there is none, a ValueError if it is too large."""
        member = self.getinfo(name)
        if member.file_size > max(SMALL_BYTES, MOST_RATIO * member.compress_size) or member.file_size > self._left:
            raise ValueError(f"{name} is larger than it can be")
        self._left -= member.file_size
        return self.read(member)


DAMAGED = (
    *(UnusableFileError, MimocError, zipfile.BadZipFile, zlib.error, NotImplementedError, EOFError, OSError),
    *(RuntimeError, RecursionError, KeyError, IndexError, ValueError, TypeError, AttributeError, OverflowError),
)
"""Exceptions that reading a file that is not a policy may raise."""
