"""Meshes of toys that are changed by chance, in every format that is read."""

import json
import struct
from pathlib import Path

import numpy as np
from fuzz.fuzzing import Fuzzer
from fuzz.mutations import changed_bytes, changed_data, pick
from support.mesh_kinds import WRITERS, box, confetti, cup, glb_of

from mimoc.components.toys.toys4k import processing, worker
from mimoc.components.toys.toys4k.build import load_toy
from mimoc.components.toys.toys4k.dataset import find_toys

SHAPES = {"box": box(), "cup": cup(), "soup": confetti(150)}


def prepare(folder: Path) -> list[tuple[str, bytes]]:
    return [(kind, write(shape)) for kind, write in WRITERS.items() for shape in SHAPES.values()]


def attempt(prepared: list[tuple[str, bytes]], generator: np.random.Generator, folder: Path) -> None:
    """Change one of them, or call it by another format, and make a toy of it.

    It is read in this process, which its reader otherwise is not; coacd, which takes seconds, is left out.
    """
    kind, content = pick(generator, prepared)
    chance = generator.random()
    if chance < 0.1:
        kind = pick(generator, sorted(WRITERS))
    elif chance < 0.2:
        content = content[: int(generator.integers(len(content)))]
    elif chance < 0.5 and kind == "glb":
        content = _changed_glb(generator, content)
    else:
        content = changed_bytes(generator, content)
    (folder / f"toy.{kind}").write_bytes(content)
    reader, parts = processing.run_worker, processing.convex_parts
    processing.run_worker, processing.convex_parts = read_here, lambda mesh, simple: [processing.hull(mesh.vertices)]
    try:
        load_toy(find_toys(folder), "toy")
    finally:
        processing.run_worker, processing.convex_parts = reader, parts


def _changed_glb(generator: np.random.Generator, content: bytes) -> bytes:
    length = struct.unpack_from("<I", content, 12)[0]
    described = changed_data(generator, json.loads(content[20 : 20 + length]))
    return glb_of(described, content[28 + length :])


def read_here(task: str, content: bytes, *arguments: object, limit_s: int) -> worker.Arrays:
    try:
        return worker.TASKS[task](content, *map(str, arguments))
    except worker.RefusedError as error:
        raise worker.WorkerError(" ".join(str(error).split())) from None
    except MemoryError:
        raise worker.WorkerError(f"takes too much memory to {task}") from None


FUZZER = Fuzzer(prepare, attempt, short=40)
