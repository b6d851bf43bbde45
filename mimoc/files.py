"""Single files, written whole or not at all."""

import os
import secrets
from contextlib import suppress
from pathlib import Path

from mimoc.errors import OutputError


def write_file(path: str | Path, content: bytes) -> Path:
    """Write a file into an existing folder; whoever reads it sees the old content or the new one.

    Raises:
        OutputError: If it cannot be written.
    """
    path = Path(path).expanduser()
    beside = path.parent / f".mimoc-{secrets.token_hex(8)}.tmp"
    try:
        beside.write_bytes(content)
        os.replace(beside, path)
    except OSError as error:
        raise OutputError(f"{path}: cannot be written ({error.strerror}); choose another place") from None
    finally:
        with suppress(OSError):
            beside.unlink()
    return path
