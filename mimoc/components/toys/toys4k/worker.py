"""Processing of untrusted meshes in a separate process, where a library may crash, hang or exhaust memory.

`run_worker` runs this file as a script, with limits on its time and memory. The script imports nothing from mimoc, and
reads and writes archives of arrays.
"""

import io
import os
import subprocess
import sys
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np
import numpy.typing as npt

Arrays = dict[str, np.ndarray]

REFUSED = 3  # Exit status if the standard error output is a message for the user.


class RefusedError(Exception):
    """A mesh cannot be used; the message says why."""


def main(task: str, memory_bytes: str, processor_s: str, *arguments: str) -> int:
    """Run a task on the standard input, and write its result to the standard output."""
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # What libraries print goes to the standard error output.
    # Limit memory and CPU time and disable core dumps, where the system supports it.
    with suppress(ImportError):
        import resource

        limits = {"RLIMIT_CORE": 0, "RLIMIT_CPU": int(processor_s), "RLIMIT_AS": int(memory_bytes)}
        for name, most in limits.items():
            with suppress(AttributeError, OSError, ValueError):
                resource.setrlimit(getattr(resource, name), (most, most))
    try:
        result = TASKS[task](sys.stdin.buffer.read(), *arguments)
    except (RefusedError, MemoryError) as error:
        reason = str(error) if isinstance(error, RefusedError) else f"takes too much memory to {task}"
        sys.stderr.write("\n" + " ".join(reason.split()))
        return REFUSED
    with answers:
        np.savez(answers, allow_pickle=False, **result)
    return 0


def read(content: bytes, kind: str, most_faces: str) -> Arrays:
    """Return all triangles of a file, with the transforms of its scene applied; materials are ignored."""
    import trimesh

    try:
        loaded = trimesh.load(
            io.BytesIO(_readable(content, kind)),
            file_type=kind,
            process=False,
            skip_materials=True,
            group_material=False,
        )
        vertices, faces = _triangles(loaded)
    except (RefusedError, MemoryError):
        raise
    except Exception as error:  # On invalid input, a parser can raise any error.
        raise RefusedError(f"is not a mesh that can be read ({type(error).__name__}: {error})"[:300]) from None
    if len(faces) > int(most_faces):
        raise RefusedError(f"has {len(faces):,} triangles, more than the limit of {int(most_faces):,}")
    if not len(faces):
        raise RefusedError("contains no triangles")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise RefusedError("has triangles with vertices that are not in the file")
    return {"vertices": vertices, "faces": faces}


def decompose(content: bytes, preprocessing: str, most_parts: str, most_corners: str) -> Arrays:
    """Return the vertices of convex parts that together approximate a mesh, one part after the other."""
    import coacd

    coacd.set_log_level("off")
    with np.load(io.BytesIO(content), allow_pickle=False) as mesh:
        vertices, faces = mesh["vertices"], mesh["faces"]
    parts = coacd.run_coacd(
        coacd.Mesh(vertices, faces),
        threshold=0.08,
        max_convex_hull=int(most_parts),
        preprocess_mode=preprocessing,
        preprocess_resolution=25,
        resolution=1000,
        mcts_nodes=10,
        mcts_iterations=30,
        mcts_max_depth=2,
        decimate=True,
        max_ch_vertex=int(most_corners),
        seed=1,  # 0 means the clock.
    )
    corners = [np.asarray(part[0], float).reshape(-1, 3) for part in parts]
    return {"corners": np.concatenate(corners), "counts": np.array([len(points) for points in corners])}


TASKS: Mapping[str, Callable[..., Arrays]] = {"read": read, "decompose": decompose}


def _readable(content: bytes, kind: str) -> bytes:
    """Return the content of a text file without non-ASCII characters, which occur only in comments and names."""
    length_of_binary = 84 + 50 * int.from_bytes(content[80:84], "little")  # According to an STL's header.
    text = kind == "obj" or (kind == "stl" and len(content) != length_of_binary)
    return content.decode("ascii", errors="replace").encode("ascii", errors="replace") if text else content


def _triangles(loaded: Any) -> tuple[np.ndarray, np.ndarray]:
    graph, geometry = getattr(loaded, "graph", None), getattr(loaded, "geometry", None)
    if graph is None or geometry is None:
        placed = [(np.eye(4), loaded)]
    else:
        placed = [(graph[node][0], geometry[graph[node][1]]) for node in graph.nodes_geometry]
    meshes = [(np.asarray(place, float), mesh) for place, mesh in placed if len(getattr(mesh, "faces", ()))]
    if not meshes:
        raise RefusedError("contains no triangles")
    with np.errstate(all="ignore"):  # Vertices that are not finite are removed later.
        vertices = [np.asarray(mesh.vertices, float) @ place[:3, :3].T + place[:3, 3] for place, mesh in meshes]
    starts = np.cumsum([0, *map(len, vertices)])
    faces = [np.asarray(mesh.faces, np.int64) + start for start, (_, mesh) in zip(starts, meshes, strict=False)]
    return np.concatenate(vertices), np.concatenate(faces)


MEMORY_BYTES = 12 * 2**30  # Address space; far less is used, but libraries with threads reserve much.
WALL_TIME_FACTOR = 4  # Limit on the wall time of a task, as a multiple of its limit on CPU time.
OUT_OF_TIME = {-24, -9}
"""Return codes of a process that ran out of CPU time: SIGXCPU, and SIGKILL where both limits are the same."""


class WorkerError(Exception):
    """A task failed; the message is a predicate without its subject, the mesh."""


class WorkerTimeoutError(WorkerError):
    """A task took too long: on a faster or less busy machine it may succeed."""


def run_worker(task: str, content: bytes, *arguments: object, limit_s: int) -> dict[str, npt.NDArray]:
    """Return the arrays that one of `TASKS` computes from its input and other arguments.

    The limit is on its CPU time, which hardly depends on how busy the machine is.

    Raises:
        WorkerError: If it rejects its input, crashes, or runs out of time or memory.
    """
    command = [sys.executable, "-P", __file__, task, str(MEMORY_BYTES), str(limit_s), *map(str, arguments)]
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
    if done.returncode == REFUSED:
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


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
