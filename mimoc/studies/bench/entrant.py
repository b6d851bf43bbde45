"""What is entered for the benchmark: a policy of mimoc's, a trained one, or a class that acts."""

import inspect
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from mimoc.base.classes import import_class
from mimoc.base.errors import PolicyError
from mimoc.bundle.io import digests
from mimoc.bundle.regular_files import UnusableFileError, read_regular_file
from mimoc.policies.class_policy import EXAMPLE, class_or_text, is_class
from mimoc.policies.named import policy_of
from mimoc.policies.policy import Policy, PolicyMaker
from mimoc.policies.spec import parse_policy
from mimoc.runtime.env import InfantEnv
from mimoc.studies.bench.table import Cell

MAX_BYTES = 2**29  # Largest file of a policy that results name: 512 MB, as for any policy.


def text_for(text: str, cell: Cell) -> str:
    """Return the policy for a task and an age: `{task}` and `{age}` stand for theirs, as in `runs/{task}_{age}.zip`."""
    return text.replace("{task}", cell.task).replace("{age}", f"{cell.age_months:g}")


def bound_policy(env: InfantEnv, text: str) -> Policy:
    """Return a policy for an environment, by name or as `module:Class`; raise a MimocError if none fits this infant."""
    return policy_of(env, class_or_text(text), _load)


def digests_of(texts: Iterable[str]) -> dict[str, str]:
    """Return digests of trained policies, named files and folders, and modules of classes, by their paths as written.

    Those that ship with mimoc are known by its version. A text that is no policy raises a MimocError.
    """
    return digests({name: path.read_bytes() for text in dict.fromkeys(texts) for name, path in _files_of(text)})


def check_files(policy: str, texts: Iterable[str], recorded: Mapping[str, str]) -> None:
    """Check that the policy of a file of results has the files that it recorded, below the current folder.

    Anyone may have written that file. So nothing outside of the current folder is read, nothing that is not recorded,
    and no module is imported before it has been compared. Other files, or some elsewhere, are a PolicyError.
    """
    trust = "; if you trust it, name it yourself with --policy"
    contents = dict[str, bytes]()
    for text in dict.fromkeys(texts):
        module = text.partition(":")[0].removesuffix(".py") if is_class(text) else ""
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
        return read_regular_file(path, MAX_BYTES) or b""
    except UnusableFileError as error:
        raise PolicyError(f"{path}: {error}") from None


def _files_of(text: str) -> Iterator[tuple[str, Path]]:
    if is_class(text):
        path = Path(inspect.getfile(import_class(text, EXAMPLE)))
        yield path.name, path
        return
    for part in parse_policy(text):
        path = Path(part.argument or "").expanduser()
        if part.argument and path.is_file():
            yield part.argument, path
        elif part.argument and path.is_dir():
            yield from ((item.as_posix(), item) for item in sorted(path.rglob("*")) if item.is_file())


def _load(path: str) -> PolicyMaker:
    """Return the trained policy in a file; PyTorch is only imported when there is one."""
    from mimoc.training import load_policy

    return load_policy(path)
