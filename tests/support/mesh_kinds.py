"""Meshes of every kind that a folder may hold, as the files they come in."""

import json
import struct
from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh
from trimesh import creation

Arrays = tuple[np.ndarray, np.ndarray]
BOX_CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)


def arrays_of(mesh: trimesh.Trimesh) -> Arrays:
    return np.array(mesh.vertices), np.array(mesh.faces)


def box(x: float = 1.0, y: float = 1.0, z: float = 1.0) -> Arrays:
    return arrays_of(creation.box((x, y, z)))


def joined(*meshes: Arrays) -> Arrays:
    starts = np.cumsum([0, *(len(vertices) for vertices, _ in meshes)])
    faces = [faces + start for start, (_, faces) in zip(starts, meshes, strict=False)]
    return np.concatenate([vertices for vertices, _ in meshes]), np.concatenate(faces)


def moved(mesh: Arrays, *by: float) -> Arrays:
    return mesh[0] + by, mesh[1]


def bumpy_ball(faces: int) -> Arrays:
    rows = int(np.ceil((faces / 4) ** 0.5)) + 1
    columns = 2 * rows
    polar = np.linspace(0, np.pi, rows + 1)[1:-1, None]
    around = np.linspace(0, 2 * np.pi, columns, endpoint=False)
    radius = 1 + 0.1 * np.sin(5 * around) * np.sin(polar) ** 3 * np.cos(4 * polar)
    grid = np.stack([np.sin(polar) * np.cos(around), np.sin(polar) * np.sin(around), np.cos(polar) + 0 * around], -1)
    vertices = np.concatenate([(radius[..., None] * grid).reshape(-1, 3), [[0, 0, 1.0], [0, 0, -1.0]]])
    number = np.arange((rows - 1) * columns).reshape(rows - 1, columns)
    a, b = number, np.roll(number, -1, axis=1)
    top, bottom = len(vertices) - 2, len(vertices) - 1
    quads = [np.stack([a[:-1], a[1:], b[1:]], -1), np.stack([a[:-1], b[1:], b[:-1]], -1)]
    caps = [np.stack([np.full(columns, top), a[0], b[0]], -1), np.stack([np.full(columns, bottom), b[-1], a[-1]], -1)]
    return vertices, np.concatenate([each.reshape(-1, 3) for each in (*quads, *caps)])


def confetti(count: int) -> Arrays:
    generator = np.random.default_rng(0)
    middles, corners = generator.random((count, 1, 3)), 0.002 * generator.random((count, 3, 3))
    return (middles + corners).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3)


def with_a_corner_at(mesh: Arrays, *place: float) -> Arrays:
    vertices = mesh[0].copy()
    vertices[0] = place
    return vertices, mesh[1]


def cup() -> Arrays:
    side = creation.cylinder(0.4, 1.0, sections=24)
    return arrays_of(side)[0], np.array(side.faces[side.face_normals[:, 2] < 0.5])


def table() -> Arrays:
    legs = [moved(box(0.1, 0.1, 0.6), x, y, -0.3) for x in (-0.4, 0.4) for y in (-0.3, 0.3)]
    return joined(box(1.0, 0.8, 0.1), *legs)


def inside_out(mesh: Arrays) -> Arrays:
    return mesh[0], mesh[1][:, ::-1]


def half_inside_out(mesh: Arrays) -> Arrays:
    faces = mesh[1].copy()
    faces[::2] = faces[::2, ::-1]
    return mesh[0], faces


USABLE: dict[str, Callable[[], Arrays]] = {  # What becomes a toy.
    "box": box,
    "table": table,
    "ball": lambda: arrays_of(creation.icosphere(subdivisions=3)),
    "torus": lambda: arrays_of(creation.torus(1.0, 0.3)),
    "single_triangle": lambda: (np.eye(3), np.array([[0, 1, 2]])),
    "flat": lambda: (np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.0]]), np.array([[0, 1, 2], [0, 2, 3]])),
    "nearly_flat": lambda: box(1.0, 0.8, 1e-4),
    "needle": lambda: box(1.0, 1e-5, 1e-5),
    "zero_volume": lambda: joined(*[(np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0.0]]), np.array([[0, 1, 2], [2, 1, 0]]))]),
    "one_nan": lambda: with_a_corner_at(box(), np.nan, 0, 0),
    "one_infinity": lambda: with_a_corner_at(box(), 0, np.inf, 0),
    "one_far_corner": lambda: with_a_corner_at(box(), 1e4, 0, 0),
    "non_manifold": lambda: joined(box(), moved(box(), 1, 1, 0), (np.eye(3), np.array([[0, 1, 2]]))),
    "three_faces_at_an_edge": lambda: (
        np.vstack([BOX_CORNERS[:4], [[1, 1, 1.0]]]),
        np.array([[0, 1, 2], [0, 1, 3], [0, 1, 4]]),
    ),
    "moebius": lambda: moebius(),
    "inside_out": lambda: inside_out(box()),
    "half_inside_out": lambda: half_inside_out(box()),
    "huge": lambda: (box()[0] * 1e6, box()[1]),
    "beyond_32_bits": lambda: (box()[0] * 1e200, box()[1]),
    "tiny": lambda: (box()[0] * 1e-30, box()[1]),
    "far_away": lambda: moved(box(), 1e6, -1e6, 1e6),
    "open": cup,
    "repeated_faces": lambda: (box()[0], np.concatenate([box()[1], box()[1], box()[1][:, ::-1]])),
    "degenerate_faces": lambda: (box()[0], np.concatenate([box()[1], [[0, 0, 1], [2, 2, 2]]])),
    "unused_corners": lambda: (np.vstack([box()[0], [[1e9, 0, 0]], np.full((1, 3), np.nan)]), box()[1]),
    "two_shells": lambda: joined(box(), moved(inside_out(box()), 3, 0, 0)),
    "nested_shells": lambda: joined(box(), (box()[0] * 0.5, box()[1])),
    "confetti": lambda: confetti(20_000),
    "many_faces": lambda: bumpy_ball(60_000),
}


def moebius() -> Arrays:
    turns = np.linspace(0, 2 * np.pi, 24, endpoint=False)
    across = np.array([-0.3, 0.3])[:, None]
    rows = [(1 + across * np.cos(turns / 2)) * f(turns) for f in (np.cos, np.sin)] + [across * np.sin(turns / 2)]
    vertices = np.stack(rows, -1).reshape(-1, 3)
    quads = [(i, (i + 1) % 24, i + 24, (i + 1) % 24 + 24) for i in range(23)] + [(23, 24, 47, 0)]
    return vertices, np.array([face for a, b, c, d in quads for face in ((a, b, d), (a, d, c))])


UNUSABLE: dict[str, tuple[bytes, str]] = {  # What is called .obj and gets an error, and what the error says.
    "empty": (b"", "is an empty file"),
    "text": (b"Dear reader,\nthis is a letter and no mesh.\n", "contains no triangles"),
    "no_faces": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\n", "contains no triangles"),
    "a_point": (b"v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n", "has all its vertices at the same point"),
    "a_line": (b"v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "has no surface"),
    "only_nan": (b"v nan 0 0\nv 1 nan 0\nv 0 1 nan\nf 1 2 3\n", "finite"),
    "a_corner_at_the_end_of_the_world": (b"v 1e30 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "has no surface"),
    "missing_corner": (b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "(IndexError|not in the file)"),
    "noise": (bytes(range(256)) * 40, "(cannot|contains no triangles|is not a mesh)"),
}


def obj(mesh: Arrays) -> bytes:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh[0].tolist()]
    lines += [f"f {a} {b} {c}" for a, b, c in (mesh[1] + 1).tolist()]
    return "\n".join(lines).encode()


def stl(mesh: Arrays) -> bytes:
    record = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("rest", "<u2")])
    records = np.zeros(len(mesh[1]), record)
    records["corners"] = mesh[0][mesh[1]]
    return bytes(80) + struct.pack("<I", len(records)) + records.tobytes()


def ply(mesh: Arrays) -> bytes:
    exported = trimesh.Trimesh(*mesh, process=False).export(file_type="ply")
    assert isinstance(exported, bytes)
    return exported


def glb(mesh: Arrays) -> bytes:
    exported = trimesh.Trimesh(*mesh, process=False).export(file_type="glb")
    assert isinstance(exported, bytes)
    return exported


def glb_of(content: dict, blob: bytes = b"") -> bytes:
    text = json.dumps(content).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
    if blob:
        chunks += struct.pack("<II", len(blob), 0x004E4942) + blob
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


WRITERS: dict[str, Callable[[Arrays], bytes]] = {"obj": obj, "stl": stl, "ply": ply, "glb": glb}


def put(root: Path, name: str, content: bytes, kind: str = "obj") -> Path:
    folder = root / name.rpartition("_")[0] / name
    folder.mkdir(parents=True, exist_ok=True)
    (folder / f"mesh.{kind}").write_bytes(content)
    return folder / f"mesh.{kind}"
