import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from support import mesh_kinds
from support.mesh_kinds import USABLE, obj, put

from mimoc.base.errors import ToyError
from mimoc.bundle.files import writer_prefix
from mimoc.compiler.toys import Mesh, Solid, ToyModel
from mimoc.components.toys.toys4k import build, meshes, worker
from mimoc.components.toys.toys4k.build import VARIABLE, MeshCache, default_folder, key_of, load_toy
from mimoc.components.toys.toys4k.dataset import Toys4K, find_toys
from mimoc.components.toys.toys4k.processing import Shape

BALL = Mesh(*mesh_kinds.arrays_of(mesh_kinds.creation.icosphere(subdivisions=1)))
BOX = Solid("box", (0.5, 0.4, 0.1), (0.0, 0.0, 0.1), (0.8, 0.6, 0.0, 0.0))
SHAPES = {
    "hulls": Shape(
        BALL, (Solid("mesh", (), mesh=BALL), Solid("mesh", (), mesh=Mesh(BALL.vertices / 3, BALL.faces))), 0.5
    ),
    "box": Shape(BALL, (BOX,), 1 / 3),
}


def same(first: Mesh | None, second: Mesh | None) -> bool:
    if first is None or second is None:
        return first is second
    return np.array_equal(first.vertices, second.vertices) and np.array_equal(first.faces, second.faces)


def equal(first: Shape | None, second: Shape | None) -> bool:
    if first is None or second is None or len(first.solids) != len(second.solids):
        return first is second
    pairs = zip(first.solids, second.solids, strict=True)
    solids = [
        same(a.mesh, b.mesh) and (a.type, a.size, a.pos, a.quat) == (b.type, b.size, b.pos, b.quat) for a, b in pairs
    ]
    return same(first.looks, second.looks) and first.volume == second.volume and all(solids)


def entries(folder: Path) -> list[Path]:
    return sorted((folder / "meshes").iterdir())


@pytest.mark.parametrize("kind", SHAPES)
def test_a_shape_comes_back_to_the_last_digit(kind, tmp_path):
    MeshCache(tmp_path).save("key", SHAPES[kind])
    assert equal(MeshCache(tmp_path).load("key"), SHAPES[kind])
    assert MeshCache(tmp_path).load("another") is None


def test_what_comes_back_cannot_be_changed(tmp_path):
    MeshCache(tmp_path).save("key", SHAPES["hulls"])
    shape = MeshCache(tmp_path).load("key")
    assert shape
    with pytest.raises(ValueError, match="read-only"):
        shape.looks.vertices[0] = 1


@pytest.mark.parametrize("kind", SHAPES)
def test_a_damaged_entry_is_none(kind, tmp_path):
    kept = MeshCache(tmp_path)
    kept.save("key", SHAPES[kind])
    (path,) = entries(tmp_path)
    whole = path.read_bytes()
    generator = np.random.default_rng(0)
    for length in generator.integers(0, len(whole), 40):
        path.write_bytes(whole[:length])
        assert kept.load("key") is None
    for place in generator.integers(0, len(whole), 200):
        path.write_bytes(whole[:place] + bytes([whole[place] ^ 0xFF]) + whole[place + 1 :])
        shape = kept.load("key")
        assert shape is None or equal(shape, SHAPES[kind])  # Some bytes say nothing, such as an archive's dates.


@pytest.mark.parametrize(
    "change",
    [
        {"faces": np.array([[0, 1, 99999]])},
        {"faces": np.array([[0.5, 1, 2]])},
        {"vertices": np.full((3, 3), np.nan)},
        {"vertices": np.zeros((3, 2))},
        {"volume": np.array(-1.0)},
        {"volume": np.array(np.nan)},
        {"counts": np.array([[3, 0], [39, 81]])},
        {"boxes": np.zeros((1, 3))},
        {"counts": np.array([[42, 80]])},
        {"vertices": np.array([{"an": "object"}], dtype=object)},
    ],
)
def test_an_entry_that_is_no_shape_is_none(change, tmp_path):
    kept = MeshCache(tmp_path)
    kept.save("key", SHAPES["hulls"])
    (path,) = entries(tmp_path)
    with np.load(path) as arrays:
        content = dict(arrays)
    np.savez(path, **(content | change))
    assert kept.load("key") is None


@pytest.fixture
def found(tmp_path: Path) -> Toys4K:
    put(tmp_path / "toys", "ball_000", obj(USABLE["box"]()))
    put(tmp_path / "toys", "cup_000", obj(USABLE["box"]()))
    return find_toys(tmp_path / "toys")


@pytest.fixture
def processed(quickly: None, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Return the formats of what is processed from now on."""
    kinds: list[str] = []
    process = build.process
    monkeypatch.setattr(build, "process", lambda content, kind: kinds.append(kind) or process(content, kind))
    return kinds


def shape_of(toy: ToyModel) -> Shape:
    return Shape(toy.parts[0].mesh, toy.solids, toy.volume)


def test_one_content_is_processed_once_whatever_its_name(found, processed, tmp_path):
    kept = MeshCache(tmp_path / "cache")
    toys = [load_toy(found, name, kept) for name in ("ball_000", "cup_000", "ball_000")]
    assert processed == ["obj"]
    assert [toy.name for toy in toys] == ["ball_000", "cup_000", "ball_000"]
    assert [toy.category for toy in toys] == ["ball", "cup", "ball"]
    assert all(equal(shape_of(toy), shape_of(toys[0])) for toy in toys)


def test_a_changed_file_is_processed_anew(found, processed, tmp_path):
    kept = MeshCache(tmp_path / "cache")
    assert load_toy(found, "ball_000", kept).volume == pytest.approx(1)
    found.objects["ball_000"].write_bytes(obj(mesh_kinds.box(1, 0.5, 0.5)))
    assert load_toy(found, "ball_000", kept).volume == pytest.approx(0.25)


def test_a_damaged_entry_is_made_anew(found, processed, tmp_path):
    kept = MeshCache(tmp_path / "cache")
    toy = load_toy(found, "ball_000", kept)
    (path,) = entries(tmp_path / "cache")
    path.write_bytes(b"damaged")
    assert equal(shape_of(load_toy(found, "ball_000", kept)), shape_of(toy))
    assert len(processed) == 2
    assert path.read_bytes() != b"damaged"


def test_what_could_not_be_finished_is_not_kept(found, processed, tmp_path, monkeypatch):
    def late(*_: object, **__: object) -> None:
        raise worker.WorkerTimeoutError("takes too long")

    for module in (meshes, build):
        monkeypatch.setattr(module, "has_coacd", lambda: True)
    monkeypatch.setattr(meshes, "run_worker", late)
    with pytest.raises(ToyError, match="takes too long"):
        load_toy(found, "ball_000", MeshCache(tmp_path / "cache"))
    assert not (tmp_path / "cache").exists()


def test_the_key_depends_on_all_that_decides_the_shape(monkeypatch):
    keys = {key_of(b"a", "obj"), key_of(b"b", "obj"), key_of(b"a", "stl")}
    for name in ("has_coacd", "has_simplifier"):
        has = getattr(build, name)()
        monkeypatch.setattr(build, name, lambda has=has: not has)
        keys.add(key_of(b"a", "obj"))
    monkeypatch.setattr(build, "VERSION", -1)
    keys.add(key_of(b"a", "obj"))
    assert len(keys) == 6
    assert all(len(key) == 64 for key in keys)


def test_a_cache_that_cannot_be_written_is_as_good_as_none(found, processed, tmp_path):
    (tmp_path / "file").touch()
    for folder in (tmp_path / "file", tmp_path / "file" / "below", Path("/proc/no/such/place")):
        assert load_toy(found, "ball_000", MeshCache(folder)).solids


def test_a_full_disk_is_as_good_as_no_cache(found, processed, tmp_path, monkeypatch):
    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", fail)
    assert load_toy(found, "ball_000", MeshCache(tmp_path / "cache")).solids
    assert entries(tmp_path / "cache") == []


def test_the_folder_is_that_of_the_system_or_of_the_environment(tmp_path, monkeypatch):
    monkeypatch.delenv(VARIABLE, raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "xdg"))
    if sys.platform == "linux":
        assert default_folder() == tmp_path / "xdg" / "mimoc"
    monkeypatch.setenv("HOME", str(tmp_path))
    for value, folder in ((str(tmp_path / "mine"), tmp_path / "mine"), ("~/mine", tmp_path / "mine")):
        monkeypatch.setenv(VARIABLE, value)
        assert default_folder() == folder
        assert MeshCache().folder == folder / "meshes"
    assert MeshCache(tmp_path / "other").folder == tmp_path / "other" / "meshes"


FILL = """
import sys
from pathlib import Path
from mimoc.components.toys.toys4k import build, meshes, processing, worker
from mimoc.components.toys.toys4k.build import MeshCache
from mimoc.components.toys.toys4k.build import load_toy
from mimoc.components.toys.toys4k.dataset import find_toys
meshes.has_coacd = build.has_coacd = lambda: False
processing.run_worker = lambda task, content, *told, limit_s: worker.TASKS[task](content, *map(str, told))
found = find_toys(Path(sys.argv[1]))
for _ in range(2):
    for name in found.objects:
        print(name, load_toy(found, name, MeshCache(Path(sys.argv[2]))).volume)
"""


@pytest.mark.full
def test_processes_that_fill_one_cache_at_once_leave_whole_entries(tmp_path):
    for number in range(3):
        put(tmp_path / "toys", f"box_{number:03}", obj(mesh_kinds.box(1, 1, 1 / (1 + number))))
    command = [sys.executable, "-c", FILL, str(tmp_path / "toys"), str(tmp_path / "cache")]
    running = [subprocess.Popen(command, stdout=subprocess.PIPE, text=True) for _ in range(3)]
    printed = {each.communicate()[0] for each in running}
    assert [each.returncode for each in running] == [0, 0, 0]
    assert len(printed) == 1
    kept = MeshCache(tmp_path / "cache")
    assert len(entries(tmp_path / "cache")) == 3
    assert all(kept.load(path.stem) for path in entries(tmp_path / "cache"))


def test_what_a_killed_process_was_writing_is_removed_by_the_next_one_that_saves(tmp_path):
    def name(process: int) -> str:
        return f"{writer_prefix('.mimoc-')}{process}-0123456789abcdef.tmp"

    dead = subprocess.Popen([sys.executable, "-c", ""])
    dead.wait()
    kept = [name(os.getpid()), ".mimoc-another-machine-1-0123456789abcdef.tmp"]
    (tmp_path / "meshes").mkdir()
    for each in (*kept, name(dead.pid)):
        (tmp_path / "meshes" / each).touch()
    MeshCache(tmp_path).save("key", SHAPES["box"])
    assert sorted(path.name for path in entries(tmp_path)) == sorted([*kept, "key.npz"])
