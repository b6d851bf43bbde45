import os
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import mujoco
import numpy as np
import pytest
from support import mesh_kinds
from support.full import FULL, full_but
from support.mesh_kinds import UNUSABLE, USABLE, WRITERS, obj, put

from mimoc.base.errors import ToyError
from mimoc.compiler.toys import Mesh, ToyModel
from mimoc.components.toys.toys4k import build, dataset, meshes, processing, worker
from mimoc.components.toys.toys4k.build import DENSITY_KG_M3, load_toy
from mimoc.components.toys.toys4k.dataset import FORMATS, find_toys
from mimoc.components.toys.toys4k.processing import TOPS

Load = Callable[..., ToyModel]
SMALLEST_M, LARGEST_M = 0.005, 1.0
"""The sizes that a spec may ask for."""


@pytest.fixture
def without_simplifier(monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (meshes, build):
        monkeypatch.setattr(module, "has_simplifier", lambda: False)


@pytest.fixture
def load(tmp_path: Path) -> Load:
    """Return a function from a mesh, or the content of a file, to the toy that it becomes."""

    def load(mesh: mesh_kinds.Arrays | bytes, kind: str = "obj", name: str = "thing_000") -> ToyModel:
        put(tmp_path, name, mesh if isinstance(mesh, bytes) else WRITERS[kind](mesh), kind)
        return load_toy(find_toys(tmp_path), name)

    return load


def span(mesh: Mesh) -> np.ndarray:
    return np.stack([mesh.vertices.min(axis=0), mesh.vertices.max(axis=0)])


def asset(name: str, mesh: Mesh, scale_m: float, inertia: str) -> str:
    vertices = " ".join(f"{value:.9g}" for value in (mesh.vertices * scale_m).ravel())
    faces = " ".join(map(str, mesh.faces.ravel()))
    return f'<mesh name="{name}" inertia="{inertia}" vertex="{vertices}" face="{faces}"/>'


def compiled(toy: ToyModel, size_m: float) -> mujoco.MjModel:
    """Return a toy on a floor."""
    assets, geoms = [asset("looks", toy.parts[0].mesh, size_m, "shell")], []
    for index, solid in enumerate(toy.solids):
        place = " ".join(f"{value * size_m:.9g}" for value in solid.pos)
        turn = " ".join(f"{value:.9g}" for value in solid.quat)
        if solid.mesh:
            assets.append(asset(f"solid{index}", solid.mesh, size_m, "convex"))
        size = " ".join(f"{value * size_m:.9g}" for value in solid.size)
        shape = f'mesh="solid{index}"' if solid.mesh else f'size="{size}"'
        geoms.append(f'<geom type="{solid.type}" {shape} pos="{place}" quat="{turn}" density="{DENSITY_KG_M3}"/>')
    return mujoco.MjModel.from_xml_string(
        f"""<mujoco><compiler boundinertia="1e-13"/><option timestep="0.002"/>
        <asset>{"".join(assets)}</asset><worldbody>
        <geom type="plane" size="5 5 1"/><body pos="0 0 {0.001 * size_m}"><freejoint/>{"".join(geoms)}
        <geom type="mesh" mesh="looks" mass="0" contype="0" conaffinity="0" group="2"/></body></worldbody></mujoco>"""
    )


def lean_deg_after(toy: ToyModel, seconds: float) -> float:
    """Return how far a toy of 10 cm leans some time after it was put on a floor."""
    model = compiled(toy, 0.1)
    data = mujoco.MjData(model)
    for _ in range(round(seconds / model.opt.timestep)):
        mujoco.mj_step(model, data)
    return float(np.degrees(np.arccos(np.clip(data.body(1).xmat[8], -1, 1))))


def assert_usable(toy: ToyModel) -> None:
    (part,) = toy.parts
    low, high = span(part.mesh)
    assert 0 < len(part.mesh.faces) <= 5000
    assert (high - low).max() == pytest.approx(1)
    assert low[2] == pytest.approx(0, abs=1e-12)
    assert (low + high)[:2] == pytest.approx(0, abs=1e-12)
    assert all(solid.mesh is None or len(solid.mesh.vertices) <= 64 for solid in toy.solids)
    assert 0 < len(toy.solids) <= 10
    assert 1e-6 < toy.volume < 1.1
    for size_m in (SMALLEST_M, LARGEST_M):
        assert compiled(toy, size_m).body_mass[1] > 0


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("kind", USABLE)
def test_every_kind_of_mesh_that_has_a_surface_is_a_toy_that_mujoco_takes(kind, load):
    assert_usable(load(USABLE[kind]()))


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("kind", UNUSABLE)
def test_every_other_kind_is_an_error_that_names_the_object(kind, load):
    content, reason = UNUSABLE[kind]
    with pytest.raises(ToyError, match=rf"(?s)^'thing_000' \(thing/thing_000/mesh.obj\) .*{reason}.*repair the file$"):
        load(content)


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("format_", WRITERS)
def test_every_format_is_read(format_, load):
    toy = load(mesh_kinds.box(1, 0.5, 0.5), format_)
    assert_usable(toy)
    assert toy.volume == pytest.approx(0.25)
    assert span(toy.parts[0].mesh)[1] == pytest.approx([0.5, 0.25, 0.5])


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("format_", ["ply", "glb", "stl"])
@pytest.mark.parametrize("content", [b"x", b"ply\nformat ascii 1.0\n", b"solid\nfacet", b"glTF\2\0\0\0", bytes(300)])
def test_no_format_trusts_its_content(content, format_, load):
    with pytest.raises(ToyError, match=r"^'thing_000' "):
        load(content, format_)


def test_every_format_that_is_found_can_be_read_and_has_a_top():
    assert set(FORMATS) == TOPS.keys() == WRITERS.keys()


@pytest.mark.usefixtures("quickly")
def test_a_toy_says_what_it_is_and_where_it_comes_from(load):
    toy = load(mesh_kinds.box(), name="chess_piece_012")
    assert (toy.name, toy.category) == ("chess_piece_012", "chess_piece")
    assert toy.source == "chess_piece/chess_piece_012/mesh.obj of Toys4K (Stojanov et al. 2021), not to be passed on"


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize(
    ("kind", "volume"),
    [
        ("box", 1),
        ("inside_out", 1),
        ("half_inside_out", 1),
        ("huge", 1),
        ("beyond_32_bits", 1),
        ("tiny", 1),
        ("far_away", 1),
        ("repeated_faces", 1),
        ("unused_corners", 1),
        ("degenerate_faces", 1),
        ("two_shells", 2 / 4**3),
        ("open", np.pi * 0.4**2),
    ],
)
def test_the_volume_is_what_is_within_whatever_is_wrong_with_the_mesh(kind, volume, load):
    assert load(USABLE[kind]()).volume == pytest.approx(volume, rel=0.02)


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("kind", ["inside_out", "half_inside_out", "two_shells", "torus", "repeated_faces"])
def test_the_faces_of_closed_shells_look_outwards(kind, load):
    mesh = load(USABLE[kind]()).parts[0].mesh
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    starts = {edge for face in mesh.faces.tolist() for edge in zip(face, face[1:] + face[:1], strict=True)}
    assert np.einsum("ij,ij->", np.cross(a, b), c) > 0
    assert all((end, start) in starts for start, end in starts)


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("kind", ["open", "single_triangle", "flat"])
def test_open_shells_are_seen_from_both_sides(kind, load):
    mesh = load(USABLE[kind]()).parts[0].mesh
    a, b, c = (mesh.vertices[mesh.faces[:, corner]] for corner in range(3))
    assert np.cross(b - a, c - a).sum(axis=0) == pytest.approx(0, abs=1e-9)


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("kind", ["single_triangle", "flat", "nearly_flat", "needle", "zero_volume"])
def test_what_is_flat_touches_as_a_thin_box(kind, load):
    (solid,) = load(USABLE[kind]()).solids
    assert solid.type == "box"
    assert meshes.THIN / 4 < min(solid.size) < meshes.THIN / 2 * 1.01
    assert solid.pos[2] == pytest.approx(solid.size[2])


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("kind", ["table", "open", "flat", "needle", "moebius", "many_faces", "three_faces_at_an_edge"])
@pytest.mark.parametrize("format_", ["obj", "stl"])
def test_a_toy_that_is_set_down_stays_as_it_is(kind, format_, load):
    assert lean_deg_after(load(USABLE[kind](), format_), 1.0) < 6


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize(("format_", "top"), [("obj", 1), ("glb", 1), ("stl", 2), ("ply", 2)])
def test_the_top_is_where_the_format_has_it(format_, top, load):
    """A cone stands on its base, whose axis is y or z."""
    vertices, faces = mesh_kinds.arrays_of(mesh_kinds.creation.cone(0.3, 1.0, sections=16))
    looks = load((np.roll(vertices, top - 2, axis=1), faces), format_).parts[0].mesh
    assert span(looks)[1][2] == pytest.approx(1)
    assert np.ptp(looks.vertices[looks.vertices[:, 2] > 0.9], axis=0) == pytest.approx(0)


@pytest.mark.usefixtures("quickly")
@pytest.mark.parametrize("turned", [False, True])
def test_what_would_fall_over_is_set_down_on_another_side(turned, load):
    """A cone on its tip, or with neither axis up."""
    vertices, faces = mesh_kinds.arrays_of(mesh_kinds.creation.cone(0.3, 1.0, sections=16))
    axes = np.linalg.qr(np.array([[1.0, 2, 3], [2, -1, 1], [1, 1, -2]]))[0] if turned else np.diag([1.0, -1, -1])
    toy = load((vertices @ axes.T, faces), "stl")
    assert lean_deg_after(toy, 1.0) < 6


@pytest.mark.full
@pytest.mark.usefixtures("quickly", "without_simplifier")
@pytest.mark.parametrize("kind", full_but(["confetti"], ["many_faces"]))
def test_few_faces_are_left_without_the_library_for_it(kind, load):
    assert_usable(load(USABLE[kind]()))


@pytest.mark.usefixtures("quickly")
@FULL
def test_hundreds_of_thousands_of_faces_keep_their_shape(load):
    toy = load(mesh_kinds.bumpy_ball(300_000), "stl")
    assert_usable(toy)
    assert len(toy.parts[0].mesh.faces) > 4000
    radii = np.linalg.norm(toy.parts[0].mesh.vertices - span(toy.parts[0].mesh).mean(axis=0), axis=1)
    assert 0.4 < radii.min() < radii.max() < 0.55


def test_too_many_faces_are_an_error(load, monkeypatch):
    monkeypatch.setattr(processing, "MAX_FACES_READ", 10)
    with pytest.raises(ToyError, match="has 12 triangles, more than the limit of 10"):
        load(mesh_kinds.box())


def test_too_large_a_file_is_an_error(load, monkeypatch):
    monkeypatch.setattr(dataset, "MAX_BYTES", 10)
    with pytest.raises(ToyError, match="is larger than 0 MB"):
        load(mesh_kinds.box())


def test_a_file_that_was_moved_out_of_the_root_meanwhile_is_an_error(tmp_path):
    root = tmp_path / "root"
    path = put(root, "ball_000", obj(mesh_kinds.box()))
    found = find_toys(root)
    path.rename(tmp_path / "mesh.obj")
    with pytest.raises(ToyError, match=r"^'ball_000' .* cannot be read \(No such file or directory\)"):
        load_toy(found, "ball_000")
    path.symlink_to(tmp_path / "mesh.obj")
    with pytest.raises(ToyError, match=r"^'ball_000' .* is a link to a file outside"):
        load_toy(found, "ball_000")


@pytest.mark.parametrize(("name", "reason"), [("bal_000", "did you mean 'ball_000'"), ("ball", "is a category")])
def test_a_toy_that_is_not_there_is_an_error(name, reason, tmp_path):
    put(tmp_path, "ball_000", obj(mesh_kinds.box()))
    with pytest.raises(ToyError, match=reason):
        load_toy(find_toys(tmp_path), name)


@pytest.mark.full
@pytest.mark.usefixtures("without_coacd")
def test_no_other_file_is_read(load, tmp_path):
    """A material file that cannot even be opened without waiting for ever, and a buffer elsewhere."""
    os.mkfifo(tmp_path / "materials.mtl")
    (tmp_path / "thing" / "thing_000").mkdir(parents=True)
    (tmp_path / "thing" / "thing_000" / "materials.mtl").symlink_to(tmp_path / "materials.mtl")
    assert_usable(load(b"mtllib materials.mtl\nmtllib ../../materials.mtl\nusemtl red\n" + obj(mesh_kinds.box())))
    elsewhere = {"buffers": [{"uri": "../../secret.bin", "byteLength": 36}]}
    with pytest.raises(ToyError, match=r"^'other_000' "):
        load(mesh_kinds.glb_of(triangle_of(1) | elsewhere), "glb", "other_000")


def triangle_of(count: int) -> dict:
    """Return what a .glb file says about a triangle that is used by some nodes."""
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": list(range(count))}],
        "nodes": [{"mesh": 0}] * count,
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"byteLength": 36}],
        "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    }


CORNERS = np.eye(3, dtype="<f4").tobytes()


@pytest.mark.full
@pytest.mark.usefixtures("without_coacd")
@pytest.mark.parametrize(
    "change",
    full_but(
        [
            {"nodes": [{"mesh": 0, "children": [0]}]},
            {"accessors": [{"bufferView": 0, "componentType": 5126, "count": 10**13, "type": "VEC3"}]},
        ],
        [
            {"accessors": [{"componentType": 5126, "count": 10**13, "type": "VEC3"}]},
            {"bufferViews": [{"buffer": 0, "byteLength": 36, "byteOffset": -36}]},
            {"meshes": [{"primitives": [{"attributes": {"POSITION": 7}}]}]},
        ],
    ),
)
def test_a_scene_that_lies_is_an_error_or_a_toy(change, load):
    try:
        toy = load(mesh_kinds.glb_of(triangle_of(1) | change, CORNERS), "glb")
    except ToyError as error:
        assert error.name == "thing_000"  # noqa: PT017
    else:
        assert_usable(toy)


@pytest.mark.usefixtures("quickly")
def test_what_is_where_in_a_scene_counts(load):
    scene = triangle_of(2)
    scene["nodes"] = [{"mesh": 0}, {"mesh": 0, "translation": [0, 4, 0]}]
    assert len(load(mesh_kinds.glb_of(scene, CORNERS), "glb").parts[0].mesh.faces) == 4


def with_holes(mesh: mesh_kinds.Arrays, share: float) -> mesh_kinds.Arrays:
    """Return a mesh without some of its faces."""
    vertices, faces = mesh
    kept = np.random.default_rng(0).random(len(faces)) > share
    kept[0] = False
    return vertices, faces[kept]


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize("share", [0.0, 0.02, 0.2, 0.6])
def test_what_has_holes_collides_as_its_hull_at_once_with_a_note(share, load, monkeypatch):
    monkeypatch.setattr(meshes, "has_coacd", lambda: True)
    monkeypatch.setattr(meshes, "run_worker", lambda *_, **__: pytest.fail("coacd was called"))
    toy = load(with_holes(mesh_kinds.bumpy_ball(1280), share))
    assert_usable(toy)
    assert len(toy.solids) == 1
    assert [note.partition(" has holes")[1:] for note in toy.notes] == [
        (" has holes", ": what is open collides as its convex hull")
    ]


@pytest.mark.usefixtures("reading_here")
def test_closed_shells_beside_what_has_holes_are_divided_as_ever(load, monkeypatch):
    monkeypatch.setattr(meshes, "has_coacd", lambda: True)
    seen = []
    monkeypatch.setattr(meshes, "run_worker", lambda *arguments, **_: seen.append(arguments) or _refuse())
    ball = with_holes(mesh_kinds.bumpy_ball(320), 0.2)
    toy = load(mesh_kinds.joined(ball, mesh_kinds.moved(mesh_kinds.box(), 3.0, 0.0, 0.0)))
    assert_usable(toy)
    assert (len(seen), len(toy.solids), len(toy.notes)) == (1, 2, 1)


def _refuse():
    raise worker.WorkerError("fails")


@pytest.mark.full
@pytest.mark.usefixtures("reading_here")
def test_coacd_keeps_hollows_open(load):
    toy = load(USABLE["torus"]())
    assert_usable(toy)
    assert len(toy.solids) > 3
    middle = min(np.linalg.norm(solid.mesh.vertices[:, :2], axis=1).min() for solid in toy.solids if solid.mesh)
    assert middle > 0.2
    assert lean_deg_after(toy, 0.5) < 6


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize("kind", full_but(["nested_shells"], ["non_manifold", "table"]))
def test_coacd_takes_what_is_not_one_closed_shell(kind, load):
    assert_usable(load(USABLE[kind]()))


@pytest.mark.usefixtures("reading_here")
@FULL
def test_coacd_gives_the_same_parts_again(load):
    first, second = (load(mesh_kinds.arrays_of(mesh_kinds.creation.torus(1, 0.4, 16, 8))).solids for _ in range(2))
    for one, other in zip(first, second, strict=True):
        assert one.mesh
        assert other.mesh
        assert np.array_equal(one.mesh.vertices, other.mesh.vertices)


@pytest.fixture
def spoil_coacd(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Callable[[str], None]:
    """Return a function that puts a line before the import of coacd in the process that uses it."""

    def spoil(line: str) -> None:
        source = Path(worker.__file__).read_text(encoding="utf-8")
        (tmp_path / "worker.py").write_text(source.replace("    import coacd\n", f"    {line}\n    import coacd\n"))
        assert (tmp_path / "worker.py").read_text() != source
        monkeypatch.setattr(worker, "__file__", str(tmp_path / "worker.py"))
        monkeypatch.setattr(meshes, "has_coacd", lambda: True)

    return spoil


@pytest.mark.usefixtures("reading_here")
@pytest.mark.parametrize("line", ["import os; os.abort()", "raise SystemExit(0)", "print('hello')", "import nowhere"])
def test_if_coacd_fails_the_convex_hull_is_taken(line, load, spoil_coacd):
    spoil_coacd(line)
    toy = load(USABLE["box"]())
    assert_usable(toy)
    assert len(toy.solids) == 1


@pytest.mark.usefixtures("reading_here")
def test_a_toy_on_which_coacd_takes_too_long_is_an_error_and_never_another_body(load, spoil_coacd, monkeypatch):
    spoil_coacd("while True: pass")
    monkeypatch.setattr(meshes, "LIMIT_S", 1)
    with pytest.raises(ToyError, match=r"^'thing_000' \(.*\) takes more than .* s to decompose into convex parts; "):
        load(USABLE["box"]())


@pytest.mark.usefixtures("reading_here")
def test_coacd_does_not_see_a_soup_of_triangles(load, monkeypatch):
    monkeypatch.setattr(meshes, "has_coacd", lambda: True)
    monkeypatch.setattr(meshes, "run_worker", lambda *_, **__: pytest.fail("coacd was called"))
    toy = load(mesh_kinds.confetti(500))
    assert_usable(toy)
    assert len(toy.solids) == 1


def test_a_reader_that_hangs_is_ended(load, monkeypatch, tmp_path):
    (tmp_path / "worker.py").write_text("import time\ntime.sleep(1000)")
    monkeypatch.setattr(worker, "__file__", str(tmp_path / "worker.py"))
    monkeypatch.setattr(processing, "READING_LIMIT_S", 1)
    monkeypatch.setattr(worker, "WALL_TIME_FACTOR", 1)
    with pytest.raises(ToyError, match="takes more than 1 s to read"):
        load(mesh_kinds.box())


def test_a_reader_that_needs_too_much_memory_is_ended(load, monkeypatch, tmp_path):
    source = Path(worker.__file__).read_text(encoding="utf-8")
    (tmp_path / "worker.py").write_text(source.replace("    import trimesh\n", "    hoard = bytes(3 * 10**9)\n"))
    monkeypatch.setattr(worker, "__file__", str(tmp_path / "worker.py"))
    monkeypatch.setattr(worker, "MEMORY_BYTES", 10**9)
    with pytest.raises(ToyError, match="takes too much memory to read"):
        load(mesh_kinds.box())


@pytest.mark.full
def test_neither_networkx_nor_coacd_is_needed(tmp_path):
    put(tmp_path, "ball_000", obj(USABLE["two_shells"]()))
    source = f"""
import sys, pathlib
for name in ("networkx", "coacd", "fast_simplification"):
    sys.modules[name] = None
from mimoc.components.toys.toys4k import meshes
meshes.has_coacd = lambda: False
from mimoc.components.toys.toys4k.processing import TOPS
from mimoc.components.toys.toys4k.dataset import FORMATS, find_toys
from mimoc.components.toys.toys4k.build import load_toy
assert "trimesh" not in sys.modules
print(len(load_toy(find_toys(pathlib.Path({str(tmp_path)!r})), "ball_000").solids))
"""
    done = subprocess.run([sys.executable, "-c", source], capture_output=True, text=True, check=True)
    assert done.stdout == "1\n"
