"""Files that nobody may open or change, watched by the system, so that what MuJoCo opens is seen as well."""

import ctypes
import os
import struct
from pathlib import Path

TOUCHED = 0x20 | 0x2 | 0x40 | 0x80 | 0x100 | 0x200
"""IN_OPEN, IN_MODIFY, IN_MOVED_FROM, IN_MOVED_TO, IN_CREATE and IN_DELETE (inotify(7))."""
IN_NONBLOCK = os.O_NONBLOCK
HEADER = struct.Struct("iIII")
"""Of an event: watch, mask, cookie, and the length of the name that follows (inotify(7))."""


class Canaries:
    """A folder of files outside of all bundles, with a few that a stranger's bundle may refer to."""

    def __init__(self, folder: Path, contents: dict[str, bytes]):
        """Write the files, and watch the folder from then on (Linux)."""
        folder.mkdir(parents=True)
        for name, content in contents.items():
            (folder / name).write_bytes(content)
        self.folder = folder
        library = ctypes.CDLL(None, use_errno=True)
        self._handle = library.inotify_init1(IN_NONBLOCK)
        if self._handle < 0 or library.inotify_add_watch(self._handle, os.fsencode(folder), TOUCHED) < 0:
            raise OSError(ctypes.get_errno(), "cannot watch", str(folder))

    def opened(self) -> list[str]:
        """Return the names of the files that have been opened, made, changed or removed since the last call.

        A dot stands for the folder itself, which was listed.
        """
        try:
            events = os.read(self._handle, 2**16)
        except BlockingIOError:
            return []
        names, place = set[str](), 0
        while place < len(events):
            length = HEADER.unpack_from(events, place)[3]
            name = events[place + HEADER.size : place + HEADER.size + length]
            names.add(os.fsdecode(name.rstrip(b"\0")) or ".")
            place += HEADER.size + length
        return sorted(names)

    def close(self) -> None:
        os.close(self._handle)
