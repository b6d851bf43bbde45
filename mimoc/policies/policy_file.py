"""Files of trained policies, read once: what they say of themselves, and their arrays."""

import io
import json
import zipfile
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.errors import MimocError, PolicyError, UnknownNameError
from mimoc.bundle.arrays import unpack_arrays
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file
from mimoc.runtime.infant import Infant

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


def interface_of(env: Infant) -> dict[str, Any]:
    """Return shape and layout (empty for images) of each observation, and the actuators that the action commands."""
    spaces = spaces_of(env).items()
    observes = {name: {"shape": list(part.shape), "layout": _layout(env, name)} for name, part in spaces}
    return {"observes": observes, "commands": list(env.manifest.commands)}


def is_description(about: Any) -> bool:
    """Return whether data is what describes a policy in its file."""
    names = [about["infant"], *about["commands"]]
    for name, observation in about["observes"].items():
        names += [name, *observation["layout"]]
        if not all(type(size) is int for size in observation["shape"]):
            return False
    limit = about["settings"].get("steps_per_episode")
    if limit is not None and (type(limit) is not int or limit < 1):
        return False
    return all(isinstance(name, str) and name.isprintable() for name in names)


def check_fits(path: Path, about: Mapping[str, Any], interface: Mapping[str, Any]) -> None:
    """Raise a PolicyError if the policy in a file does not fit the interface of an infant."""
    if problems := differences(about, interface):
        raise PolicyError(f"{path}: trained for a different infant, '{about['infant']}': {'; '.join(problems)}")


def differences(about: Mapping[str, Any], interface: Mapping[str, Any]) -> list[str]:
    """Return how observations and actuators of the infant in training differ from those of another one."""
    trained, current = about["observes"], interface["observes"]
    result = [f"observation '{name}' is missing here" for name in trained.keys() - current.keys()]
    result += [f"observation '{name}' was not there in training" for name in current.keys() - trained.keys()]
    for name in trained.keys() & current.keys():
        if (then := tuple(trained[name]["shape"])) != (now := tuple(current[name]["shape"])):
            result.append(f"'{name}' had shape {then} in training and has {now} here")
        else:
            result += _first_difference(f"'{name}'", trained[name]["layout"], current[name]["layout"])
    commanded, commands = about["commands"], interface["commands"]
    if len(commanded) != len(commands):
        number = f"{len(commanded)} actuators in training and commands {len(commands)} here"
        return [*sorted(result), f"the action commanded {number}"]
    return [*sorted(result), *_first_difference("the action", commanded, commands)]


def spaces_of(env: Infant) -> Mapping[str, Any]:
    """Return the space of each observation of an infant, by name."""
    space: Any = env.observation_space
    return space.spaces


def _first_difference(what: str, trained: Sequence[str], current: Sequence[str]) -> list[str]:
    for number, (then, now) in enumerate(zip(trained, current, strict=False)):
        if then != now:
            return [f"element {number} of {what} was {then} in training and is {now} here"]
    return []


def _layout(env: Infant, name: str) -> list[str]:
    try:
        return list(env.layout(name))
    except UnknownNameError:  # An image, or an observation of the task.
        return []
