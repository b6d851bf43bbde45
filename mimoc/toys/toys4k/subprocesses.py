"""Work on a mesh in a process of its own, with limits on its time and memory."""

import io
import os
import subprocess
import sys
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from mimoc.toys.toys4k import worker

MEMORY_BYTES = 12 * 2**30
"""Address space; what is used stays far below, but libraries with threads ask for much."""
PATIENCE = 4
"""The time on the clock that work may take, of what it may take of processors."""
OUT_OF_TIME = {-24, -9}
"""What the end of a process says that ran out of its time: SIGXCPU, and SIGKILL where both limits are the same."""


class ApartError(Exception):
    """Work that came to nothing, and why, as the end of a sentence about the mesh."""


class LateError(ApartError):
    """Work that came to nothing as the machine was busy: it may not the next time."""


def do_apart(task: str, content: bytes, *arguments: object, limit_s: int) -> dict[str, npt.NDArray]:
    """Return the arrays that a task of `mimoc.toys.toys4k.worker` makes of some content.

    Args:
        task: Its name.
        content: What it works on.
        arguments: What else it needs.
        limit_s: The time of processors it may take, which a busy machine does not change much.

    Raises:
        ApartError: If it refuses, crashes, or runs out of time or memory.
    """
    command = [sys.executable, "-P", worker.__file__, task, str(MEMORY_BYTES), str(limit_s), *map(str, arguments)]
    try:
        done = subprocess.run(
            command, input=content, capture_output=True, timeout=PATIENCE * limit_s, env=_environment()
        )
        if done.returncode == 0:
            with np.load(io.BytesIO(done.stdout), allow_pickle=False) as arrays:
                return dict(arrays)
    except subprocess.TimeoutExpired:
        raise LateError(f"takes more than {PATIENCE * limit_s} s to {task}") from None
    except (OSError, ValueError, EOFError, BadZipFile) as error:
        raise ApartError(f"fails to {task} ({error})") from None
    if done.returncode == worker.REFUSED:
        raise ApartError(done.stderr.decode(errors="replace").splitlines()[-1])
    if done.returncode in OUT_OF_TIME:
        raise ApartError(f"takes more than {limit_s} s to {task}")
    raise ApartError(f"fails to {task}, with exit status {done.returncode}")


def _environment() -> dict[str, str]:
    """Return the environment of a worker: it finds the same libraries, and few threads that do not wait in circles."""
    paths = [path for path in sys.path if Path(path).is_absolute()]
    return {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(paths),
        "OMP_NUM_THREADS": "4",
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_WAIT_POLICY": "passive",
    }
