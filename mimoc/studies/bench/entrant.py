"""What is entered for the benchmark: a policy of mimoc's, a trained one, or a class that acts."""

import inspect
from collections.abc import Iterable, Iterator
from pathlib import Path

from mimoc.base.classes import import_class
from mimoc.bundle.io import digests
from mimoc.policies.class_policy import EXAMPLE, class_or_text, is_class
from mimoc.policies.named import policy_of
from mimoc.policies.policy import Policy, PolicyMaker
from mimoc.policies.spec import parse_policy
from mimoc.runtime.env import InfantEnv
from mimoc.studies.bench.table import Cell


def text_for(text: str, cell: Cell) -> str:
    """Return the policy for a task and an age: `{task}` and `{age}` stand for theirs, as in `runs/{task}_{age}.zip`."""
    return text.replace("{task}", cell.task).replace("{age}", f"{cell.age_months:g}")


def bound_policy(env: InfantEnv, text: str) -> Policy:
    """Return a policy for an environment: all that `policy_of` takes by name, or a class as `module:Class`.

    Raises:
        MimocError: If there is no such policy, or it does not fit this infant.
    """
    return policy_of(env, class_or_text(text), _load)


def digests_of(texts: Iterable[str]) -> dict[str, str]:
    """Return the digests of all files that decide what policies do, by their paths as they were written.

    These are trained policies, files and folders named after a colon, and the modules of classes. Those that ship with
    mimoc are known by its version.

    Raises:
        MimocError: If a text is no policy.
    """
    return digests(dict(item for text in dict.fromkeys(texts) for item in _files_of(text)))


def _files_of(text: str) -> Iterator[tuple[str, bytes]]:
    if is_class(text):
        path = Path(inspect.getfile(import_class(text, EXAMPLE)))
        yield path.name, path.read_bytes()
        return
    for part in parse_policy(text):
        path = Path(part.argument or "").expanduser()
        if part.argument and path.is_file():
            yield part.argument, path.read_bytes()
        elif part.argument and path.is_dir():
            inside = sorted(item for item in path.rglob("*") if item.is_file())
            yield from ((item.as_posix(), item.read_bytes()) for item in inside)


def _load(path: str) -> PolicyMaker:
    """Return the trained policy in a file; PyTorch is only imported when there is one."""
    from mimoc.training import load_policy

    return load_policy(path)
