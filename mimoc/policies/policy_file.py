"""Files of trained policies, read once: what they say of themselves, and their arrays."""

import io
import json
import zipfile
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.errors import MimocError, PolicyError
from mimoc.bundle.arrays import unpack_arrays
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file
from mimoc.policies.interface import is_description

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


ABOUT, WEIGHTS = "mimoc.json", "weights.npz"
"""The files in every policy archive: its description, and its arrays."""
OF_AGENT, OF_NETWORK = 2, 3
"""Versions of files: of agents of Stable-Baselines3, and of one plain network. Those of version 1 had no arrays."""
NO_SUCH_FILE = "there is no such file; name the policy.zip of a training run"
NOT_A_POLICY = "not a policy trained by mimoc, or it is damaged"
OTHER_VERSION = "was saved by another version of mimoc; train it again"


@dataclass(frozen=True)
class PolicyFile:
    """A trained policy as its file has it; no code from the file is run."""

    path: Path
    about: dict[str, Any]
    """Its description; see `interface_of`."""
    archive: Archive

    def arrays(self, name: str) -> dict[str, np.ndarray]:
        """Return the arrays in a file of the archive; raise one of `DAMAGED` if there are none."""
        return unpack_arrays(self.archive.content(name))


def read_policy(path: str | Path) -> PolicyFile:
    """Read a policy's file; PolicyError if it is missing, damaged, or saved by another version of mimoc."""
    path = Path(path).expanduser()
    if not path.is_file():
        raise PolicyError(f"{path}: {NO_SUCH_FILE}")
    try:
        archive = Archive(read_regular_file(path, MOST_BYTES) or b"")
        about = json.loads(archive.content(ABOUT))
        version = about["policy"]
        if type(version) is int and version not in (OF_AGENT, OF_NETWORK):
            raise PolicyError(f"{path}: {OTHER_VERSION}")
        if type(version) is not int or not is_description(about):
            raise ValueError("it describes itself in a way that mimoc never does")
    except PolicyError:
        raise
    except DAMAGED:
        raise PolicyError(f"{path}: {NOT_A_POLICY}") from None
    return PolicyFile(path, about, archive)
