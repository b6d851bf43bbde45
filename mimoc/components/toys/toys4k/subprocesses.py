"""Processing of a mesh in a subprocess, with limits on its time and memory."""

import io
import os
import subprocess
import sys
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

from mimoc.components.toys.toys4k import worker

MEMORY_BYTES = 12 * 2**30  # Address space; far less is used, but libraries with threads reserve much.
WALL_TIME_FACTOR = 4  # Limit on the wall time of a task, as a multiple of its limit on CPU time.
OUT_OF_TIME = {-24, -9}
"""Return codes of a process that ran out of CPU time: SIGXCPU, and SIGKILL where both limits are the same."""


class WorkerError(Exception):
    """A task failed; the message is a predicate without its subject, the mesh."""


class WorkerTimeoutError(WorkerError):
    """A task took too long: on a faster or less busy machine it may succeed."""


def run_worker(task: str, content: bytes, *arguments: object, limit_s: int) -> dict[str, npt.NDArray]:
    """Return the arrays that a task of `toys4k.worker` computes from its input and other arguments.

    The limit is on its CPU time, which hardly depends on how busy the machine is.

    Raises:
        WorkerError: If it rejects its input, crashes, or runs out of time or memory.
    """
    command = [sys.executable, "-P", worker.__file__, task, str(MEMORY_BYTES), str(limit_s), *map(str, arguments)]
    try:
        done = subprocess.run(
            command, input=content, capture_output=True, timeout=WALL_TIME_FACTOR * limit_s, env=_environment()
        )
        if done.returncode == 0:
            with np.load(io.BytesIO(done.stdout), allow_pickle=False) as arrays:
                return dict(arrays)
    except subprocess.TimeoutExpired:
        raise WorkerTimeoutError(f"takes more than {WALL_TIME_FACTOR * limit_s} s to {task}") from None
    except (OSError, ValueError, EOFError, BadZipFile) as error:
        raise WorkerError(f"fails to {task} ({error})") from None
    if done.returncode == worker.REFUSED:
        raise WorkerError(done.stderr.decode(errors="replace").splitlines()[-1])
    if done.returncode in OUT_OF_TIME:
        raise WorkerTimeoutError(f"takes more than {limit_s} s to {task}")
    raise WorkerError(f"fails to {task}, with exit status {done.returncode}")


def _environment() -> dict[str, str]:
    """Return the environment of a worker: the same libraries, and few threads that do not wait actively."""
    paths = [path for path in sys.path if Path(path).is_absolute()]
    return {
        **os.environ,
        "PYTHONPATH": os.pathsep.join(paths),
        "OMP_NUM_THREADS": "4",
        "OPENBLAS_NUM_THREADS": "1",
        "OMP_WAIT_POLICY": "passive",
    }
