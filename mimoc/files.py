"""Single files, written whole or not at all."""

import os
import tempfile
from contextlib import suppress
from pathlib import Path

from mimoc.errors import OutputError


def write_file(path: str | Path, content: bytes) -> Path:
    """Write a file into an existing folder; whoever reads it sees the old content or the new one.

    Raises:
        OutputError: If it cannot be written.
    """
    path = Path(path).expanduser()
    try:
        handle, temporary = tempfile.mkstemp(prefix=f".{path.name}.", dir=path.parent)
        try:
            with os.fdopen(handle, "wb") as file:
                file.write(content)
            os.chmod(temporary, 0o666 & ~_umask())
            os.replace(temporary, path)
        except BaseException:
            with suppress(FileNotFoundError):
                os.unlink(temporary)
            raise
    except OSError as error:
        raise OutputError(f"{path}: cannot be written ({error.strerror}); choose another file") from None
    return path


def _umask() -> int:
    """Return the process's umask, which can only be read by setting it."""
    mask = os.umask(0o022)
    os.umask(mask)
    return mask
