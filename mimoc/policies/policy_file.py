"""Files of trained policies, read once: what they say of themselves, and their arrays."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.bundle.arrays import unpack_arrays
from mimoc.bundle.regular_files import read_regular_file
from mimoc.policies.archive import DAMAGED, MOST_BYTES, Archive
from mimoc.policies.interface import is_description

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
