import os
from pathlib import Path

import pytest
from support import mesh_kinds
from support.mesh_kinds import put

from mimoc.base.errors import ToyError, UnknownToysError
from mimoc.components.toys.toys4k.dataset import FORMATS, choose, expand_root, find_toys, unknown

MESH = b"v 0 0 0"


@pytest.fixture
def root(tmp_path: Path) -> Path:
    """Return a folder like that of the data set."""
    for name in ("ball_001", "ball_000", "cup_012", "chess_piece_003", "truck_003"):
        put(tmp_path, name, MESH)
    return tmp_path


def test_objects_are_found_where_toys4k_has_them(root):
    found = find_toys(root)
    assert list(found.objects) == ["ball_000", "ball_001", "chess_piece_003", "cup_012", "truck_003"]
    assert found.objects["cup_012"] == root / "cup" / "cup_012" / "mesh.obj"
    assert found.categories["ball"] == ("ball_000", "ball_001")
    assert list(found.categories) == ["ball", "chess_piece", "cup", "truck"]


@pytest.mark.parametrize("kind", FORMATS)
def test_objects_are_found_in_the_flat_layout_of_mimo(kind, tmp_path):
    for name in ("cells_battery_002", "ball_000"):
        (tmp_path / f"{name}.{kind}").write_bytes(MESH)
    found = find_toys(tmp_path)
    assert dict(found.categories) == {"ball": ("ball_000",), "cells_battery": ("cells_battery_002",)}
    assert found.objects["ball_000"] == tmp_path / f"ball_000.{kind}"


@pytest.mark.parametrize(
    ("files", "chosen"),
    [
        (("b.obj", "a.obj"), "a.obj"),
        (("a.stl", "b.ply", "c.glb", "d.obj"), "d.obj"),
        (("a.stl", "b.ply", "c.glb"), "b.ply"),
        (("a.stl", "A.OBJ"), "A.OBJ"),
        (("._mesh.obj", "mesh.stl", "mesh.mtl"), "mesh.stl"),
    ],
)
def test_of_several_meshes_the_best_is_taken(files, chosen, tmp_path):
    folder = tmp_path / "ball" / "ball_000"
    folder.mkdir(parents=True)
    for name in files:
        (folder / name).write_bytes(MESH)
    assert find_toys(tmp_path).objects["ball_000"].name == chosen


HOSTILE = {
    "a b": "a b",
    "Würfel": "Würfel",
    "Wu\u0308rfel 2": "Würfel 2",
    "3d_cube": "3d_cube",
    "<\"&'>": "<\"&'>",
    "赤い玉_001": "赤い玉_001",
    "two\nlines": "two?lines",
    "\udcff": "?",
    "MIXED_Case": "MIXED_Case",
}
"""Names of files, and how they are written down."""


def test_meshes_of_any_name_in_one_folder_are_objects(tmp_path):
    for name in HOSTILE:
        (tmp_path / f"{name}.obj").write_bytes(MESH)
    found = find_toys(tmp_path)
    assert set(found.objects) == set(HOSTILE.values())
    assert choose(found, ["赤い玉", "a b"]) == ("a b", "赤い玉_001")
    assert found.categories["3d_cube"] == ("3d_cube",)


def test_what_is_no_object_is_passed_over(root):
    (root / "README.txt").write_text("hello")
    (root / "ball" / "notes.obj").write_bytes(MESH)
    (root / "ball" / "cup_000").mkdir()
    (root / "ball" / "cup_000" / "mesh.obj").write_bytes(MESH)
    (root / "ball" / "ball_007").mkdir()
    (root / "ball" / "ball_008" / "mesh.obj").mkdir(parents=True)
    (root / "ball" / "some <name>_001.obj").write_bytes(MESH)
    os.mkfifo(root / "whistle_001.obj")
    (root / "ball" / "ball_009").symlink_to(root / "ball" / "ball_009")
    assert len(find_toys(root).objects) == 5


def test_a_root_that_does_not_exist_says_what_is_expected(tmp_path):
    with pytest.raises(ToyError, match=r"missing: cannot be read \(No such file or directory\); give the folder"):
        find_toys(tmp_path / "missing")


@pytest.mark.parametrize("root", ["a\0b", "n" * 5000])
def test_a_root_that_cannot_be_says_so(root):
    with pytest.raises(ToyError, match="cannot be read"):
        find_toys(Path(root))


def test_a_root_without_objects_says_what_is_expected(tmp_path):
    with pytest.raises(ToyError, match="contains no meshes of toys; give a folder with <category>/<category>_<N"):
        find_toys(tmp_path)


@pytest.mark.parametrize(
    ("subset", "names"),
    [
        ((), ("ball_000", "ball_001", "chess_piece_003", "cup_012", "truck_003")),
        (("ball",), ("ball_000", "ball_001")),
        (("truck_003", "cup"), ("cup_012", "truck_003")),
        (("ball_001", "ball"), ("ball_000", "ball_001")),
    ],
)
def test_a_subset_names_categories_and_objects(subset, names, root):
    assert choose(find_toys(root), subset) == names


def test_unknown_names_come_with_near_ones_all_at_once(root):
    with pytest.raises(UnknownToysError) as raised:
        choose(find_toys(root), ["bal", "truck_004", "cup"])
    assert str(raised.value).splitlines() == [
        f"'bal' is neither a category nor an object in {root}; did you mean 'ball'?",
        f"'truck_004' is neither a category nor an object in {root}; did you mean 'truck_003' or 'truck'?",
    ]
    assert list(raised.value.messages) == ["bal", "truck_004"]


@pytest.mark.parametrize("name", ["xyzzy", "../../etc/passwd", "..", "/"])
def test_a_name_near_to_none_comes_with_the_categories_that_are_there(name, root):
    assert unknown(find_toys(root), [name])[name].endswith("; choose from ball, chess_piece, cup, truck")


@pytest.fixture
def leaking(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a root with links to a mesh, a folder and a category out of it."""
    beyond = tmp_path_factory.mktemp("beyond")
    put(beyond, "pig_000", MESH)
    (root / "ball" / "ball_002").mkdir()
    (root / "ball" / "ball_002" / "mesh.obj").symlink_to(beyond / "pig" / "pig_000" / "mesh.obj")
    (root / "cup" / "cup_013").symlink_to(Path("..", "..", beyond.name, "pig", "pig_000"))
    (root / "pig").symlink_to(beyond / "pig")
    return root


def test_what_lies_out_of_the_root_is_no_object(leaking):
    found = find_toys(leaking)
    assert len(found.objects) == 5
    assert list(found.linked_away) == ["ball_002", "cup_013", "pig_000"]
    assert "pig" not in found.categories


@pytest.mark.parametrize(
    ("name", "file"), [("ball_002", "ball/ball_002/mesh.obj"), ("pig_000", "pig/pig_000/mesh.obj")]
)
def test_what_lies_out_of_the_root_is_named_when_asked_for(name, file, leaking):
    with pytest.raises(ToyError, match=rf"^'{name}' \({file}\) is a link to a file outside .*; copy the file there$"):
        choose(find_toys(leaking), [name])


def test_a_category_that_lies_out_of_the_root_is_named_when_asked_for(leaking):
    with pytest.raises(ToyError, match=r"^'pig_000' .* is a link to a file outside"):
        choose(find_toys(leaking), ["pig"])


def test_a_root_may_be_a_link_itself_and_link_within(root, tmp_path_factory):
    (root / "cup" / "cup_100").symlink_to(root / "cup" / "cup_012")
    link = tmp_path_factory.mktemp("links") / "toys"
    link.symlink_to(root)
    found = find_toys(link)
    assert not found.linked_away
    assert found.categories["cup"] == ("cup_012", "cup_100")


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("toys", "/specs/toys"),
        ("../toys", "/specs/../toys"),
        ("/toys", "/toys"),
        ("~/toys", "/home/somebody/toys"),
        ("$DATA/toys", "/data/toys"),
        ("${DATA}", "/data"),
        ("$FOLDER/toys", "/specs/sub/toys"),
    ],
)
def test_a_root_is_expanded_and_relative_to_the_spec(text, expected, monkeypatch):
    for name, value in (("HOME", "/home/somebody"), ("DATA", "/data"), ("FOLDER", "sub")):
        monkeypatch.setenv(name, value)
    assert expand_root(text, Path("/specs")) == Path(expected)


@pytest.mark.parametrize("text", ["$NOT_SET_AT_ALL/toys", "${NOT_SET_AT_ALL}/toys"])
def test_a_variable_that_is_not_set_is_an_error(text):
    with pytest.raises(ToyError, match=r"\$NOT_SET_AT_ALL is not set; set it, or write the full path$"):
        expand_root(text, Path("/specs"))


def test_somebody_without_a_home_is_an_error():
    with pytest.raises(ToyError, match="the user does not exist"):
        expand_root("~nobody_of_this_name/toys", Path("/specs"))


def test_the_test_meshes_have_names_that_are_found(tmp_path):
    for name in (*mesh_kinds.USABLE, *mesh_kinds.UNUSABLE):
        put(tmp_path, f"{name}_000", MESH)
    assert len(find_toys(tmp_path).objects) == len({*mesh_kinds.USABLE, *mesh_kinds.UNUSABLE})
