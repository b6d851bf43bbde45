"""What tests take as given, made once for all processes of a test run: bundles of specs and compiled models.

Each thing is pickled into a folder that lasts as long as the run, so that nothing of earlier code is ever read. A test
of the building itself calls `mimoc.build`, as does one that changes what is built by other means than a spec.
"""

import fcntl
import os
import pickle
import shutil
import tempfile
from collections.abc import Callable
from hashlib import sha256
from pathlib import Path
from typing import Any, TypeVar

import mujoco

import mimoc
from mimoc.compiler.measuring import compile_infant

VARIABLE = "MIMOC_TEST_STORE"  # Environment variable with the folder, which the workers of xdist inherit.
T = TypeVar("T")

_known: dict[str, Any] = {}


def open_folder() -> None:
    os.environ[VARIABLE] = tempfile.mkdtemp(prefix="mimoc-tests-")


def remove_folder() -> None:
    shutil.rmtree(os.environ.pop(VARIABLE), ignore_errors=True)


def made_once(name: str, make: Callable[[], T]) -> T:
    """Return what a function returns, or what it returned to another process of this run; it is not to be changed."""
    if name not in _known:
        path = Path(os.environ[VARIABLE]) / sha256(name.encode()).hexdigest()
        with path.with_suffix(".lock").open("w") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            if not path.exists():
                whole = path.with_suffix(".part")
                whole.write_bytes(pickle.dumps(make()))
                whole.rename(path)
        _known[name] = pickle.loads(path.read_bytes())
    return _known[name]


def built(spec: mimoc.InfantSpec | dict[str, Any] | Path) -> mimoc.Bundle:
    if isinstance(spec, Path):
        return made_once(f"bundle of {spec}", lambda: mimoc.build(spec))
    wanted = mimoc.InfantSpec.model_validate(spec)
    return made_once(f"bundle {wanted.model_dump_json(exclude_unset=True)}", lambda: mimoc.build(wanted))


def compiled(spec: mimoc.InfantSpec) -> mujoco.MjModel:
    return made_once(f"model {spec.model_dump_json(exclude_unset=True)}", lambda: compile_infant(spec))
