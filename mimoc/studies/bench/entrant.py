"""What is entered for the benchmark: a policy of mimoc's, a trained one, or a class that acts."""

import inspect
import os
import re
import traceback
from collections.abc import Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from mimoc.base.classes import import_class
from mimoc.base.errors import PolicyError
from mimoc.bundle.io import digests
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file
from mimoc.policies import POLICIES
from mimoc.policies.named import policy_of
from mimoc.policies.policy import Policy, PolicyMaker
from mimoc.policies.spec import parse_policy
from mimoc.runtime.env import InfantEnv
from mimoc.senses.sense import Observation
from mimoc.studies.bench.table import Cell

CLASS = re.compile(r"([A-Za-z_][\w.]*):[A-Za-z_]\w*")
EXAMPLE = "my_policy:Kicker"
MOST_BYTES = 2**29
"""Of a file of a policy that results name: 512 MB, as of any policy."""


class ClassPolicy:
    """A policy of a user's class, which is made anew for each task and age.

    The class is called with the environment, or, if it takes two arguments, with the spaces of observations and
    actions. `act(observation)` returns the action; `reset()`, if there is one, is called whenever an episode begins.
    """

    def __init__(self, env: InfantEnv, name: str):
        """Make an object of the class; raise a PolicyError if that fails, or it cannot act."""
        made = import_class(name, EXAMPLE)
        self._name, self._shape = name, env.action_space.shape
        arguments = (env.observation_space, env.action_space) if _takes_spaces(made) else (env,)
        self._object: Any = self._call("cannot be made", made, *arguments)
        if not callable(getattr(self._object, "act", None)):
            raise PolicyError(f"'{name}': has no method 'act'; write one that returns the action for an observation")

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action, shape (n,); raise a PolicyError if there is none."""
        action = np.asarray(self._call("act failed", self._object.act, observation))
        if action.shape != self._shape or action.dtype.kind not in "fiu" or not np.isfinite(action).all():
            wanted = f"an array of {self._shape} finite numbers, not of {action.shape} {action.dtype}"
            raise PolicyError(f"'{self._name}': act must return {wanted}")
        return action.astype(np.float32)

    def reset(self) -> None:
        """Begin an episode."""
        if hasattr(self._object, "reset"):
            self._call("reset failed", self._object.reset)

    def _call(self, what: str, function: Any, *arguments: Any) -> Any:
        try:
            return function(*arguments)
        except Exception as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            where = f"{Path(place.filename).name}:{place.lineno}"
            reason = " ".join(f"{type(error).__name__}: {error}".split())
            raise PolicyError(f"'{self._name}': {what} in {where}: {reason}") from error


def text_for(text: str, cell: Cell) -> str:
    """Return the policy for a task and an age: `{task}` and `{age}` stand for theirs, as in `runs/{task}_{age}.zip`."""
    return text.replace("{task}", cell.task).replace("{age}", f"{cell.age_months:g}")


def bound_policy(env: InfantEnv, text: str) -> Policy:
    """Return a policy for an environment: all that `policy_of` takes by name, or a class as `module:Class`.

    Raises:
        MimocError: If there is no such policy, or it does not fit this infant.
    """
    return policy_of(env, partial(ClassPolicy, name=text) if _is_class(text) else text, _load)


def digests_of(texts: Iterable[str]) -> dict[str, str]:
    """Return the digests of all files that decide what policies do, by their paths as they were written.

    These are trained policies, files and folders named after a colon, and the modules of classes. Those that ship with
    mimoc are known by its version.

    Raises:
        MimocError: If a text is no policy.
    """
    return digests({name: path.read_bytes() for text in dict.fromkeys(texts) for name, path in _files_of(text)})


def check_files(policy: str, texts: Iterable[str], recorded: Mapping[str, str]) -> None:
    """Check that the policy of a file of results has the files that it recorded, below the current folder.

    Anyone may have written that file. So nothing outside of the current folder is read, nothing that is not recorded,
    and no module is imported before it has been compared.

    Args:
        policy: The policy as it was named.
        texts: The same for each task and age.
        recorded: Digests of its files.

    Raises:
        PolicyError: If it has other files, or some elsewhere.
    """
    trust = "; if you trust it, name it yourself with --policy"
    contents = dict[str, bytes]()
    for text in dict.fromkeys(texts):
        module = text.partition(":")[0].removesuffix(".py") if _is_class(text) else ""
        if "." in module:
            raise PolicyError(f"its policy '{policy}' is in a package, whose other modules are not recorded{trust}")
        named = [f"{module}.py"] if module else [part.argument for part in parse_policy(text)]
        for path in (Path(name).expanduser() for name in named if name):
            if os.path.lexists(path) and not path.resolve().is_relative_to(Path.cwd().resolve()):
                raise PolicyError(f"its policy '{policy}' reads {path}, outside of this folder{trust}")
        for name, path in [(f"{module}.py", Path(f"{module}.py"))] if module else _files_of(text):
            if name in recorded:
                contents[name] = _content(path)
            else:
                raise PolicyError(f"its policy '{policy}' reads {name}, which is not among the files that were scored")
    if digests(contents) != recorded:
        raise PolicyError(f"the files of its policy '{policy}' are not those that were scored")


def _content(path: Path) -> bytes:
    try:
        return read_regular_file(path, MOST_BYTES) or b""
    except UnusableFileError as error:
        raise PolicyError(f"{path}: {error}") from None


def _files_of(text: str) -> Iterator[tuple[str, Path]]:
    if _is_class(text):
        path = Path(inspect.getfile(import_class(text, EXAMPLE)))
        yield path.name, path
        return
    for part in parse_policy(text):
        path = Path(part.argument or "").expanduser()
        if part.argument and path.is_file():
            yield part.argument, path
        elif part.argument and path.is_dir():
            yield from ((item.as_posix(), item) for item in sorted(path.rglob("*")) if item.is_file())


def _is_class(text: str) -> bool:
    match = CLASS.fullmatch(text)
    return bool(match) and match[1] not in POLICIES


def _takes_spaces(made: Any) -> bool:
    try:
        parameters = inspect.signature(made).parameters.values()
    except (TypeError, ValueError):
        return False
    positional = (inspect.Parameter.POSITIONAL_ONLY, inspect.Parameter.POSITIONAL_OR_KEYWORD)
    return sum(one.kind in positional and one.default is inspect.Parameter.empty for one in parameters) == 2


def _load(path: str) -> PolicyMaker:
    """Return the trained policy in a file; PyTorch is only imported when there is one."""
    from mimoc.training import load_policy

    return load_policy(path)
