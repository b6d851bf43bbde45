"""Toys and pictures that a spec names: those that are there are built in, and those that are not are pointed at."""

import io
import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
import trimesh
from lxml import etree
from PIL import Image

import mimoc
from mimoc.base.errors import SpecError
from mimoc.compiler import building

HEAD = "mimoc: 1\nname: x\nage_months: 9\n"


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("MIMOC_CACHE", str(tmp_path / "cache"))


@pytest.fixture
def toys4k() -> Path:
    """Return a folder laid out as Toys4K, with two boxes and a ball in it, and something that is no mesh."""
    root = Path("data/toys4k_obj_files")
    meshes = {
        "car_001": trimesh.creation.box((2, 1, 0.5)),
        "car_002": trimesh.creation.box((3, 1, 1)),
        "ball_001": trimesh.creation.icosphere(2),
    }
    for name, mesh in meshes.items():
        folder = root / name.rpartition("_")[0] / name
        folder.mkdir(parents=True)
        mesh.export(folder / "mesh.obj")
    (root / "cup" / "cup_001").mkdir(parents=True)
    (root / "cup" / "cup_001" / "mesh.obj").write_text("this is no mesh")
    return root


def box_stl() -> bytes:
    return trimesh.creation.box((2, 1, 1)).export(file_type="stl")


def built(scene: str) -> mimoc.Bundle:
    Path("spec.yaml").write_text(f"{HEAD}scene: {scene}\n")
    return mimoc.build(mimoc.load_spec("spec.yaml"))


def refusal(scene: str) -> str:
    with pytest.raises(SpecError) as error:
        built(scene)
    return str(error.value)


def test_toys_are_those_of_the_subset():
    toys = built("{toys: {subset: [truck, ball], count: [12, 12], size_cm: [4, 6]}}").manifest.toys
    assert {toy.object for toy in toys} == {"truck", "ball"}
    assert all(toy.source == "made by mimoc" for toy in toys)


def test_a_toy_that_there_is_none_of_is_pointed_at_with_near_ones():
    assert refusal("{toys: {subset: [ball, truk]}}") == (
        "spec.yaml:4:31: scene.toys.subset[1]: 'truk' is not one of mimoc's toys; did you mean 'truck'?"
    )


def test_more_toys_than_there_is_room_for_are_refused():
    scene = "{kind: crib, toys: {count: [50, 50], size_cm: [60, 60]}}"
    assert refusal(scene).startswith("spec.yaml:4:27: scene.toys: there is not enough space for 50 toys;")


@pytest.mark.full
def test_toys4k_is_built_in_with_its_sources(toys4k):
    bundle = built(f"{{toys: {{source: toys4k, root: {toys4k}, subset: [car], count: [4, 4], size_cm: [10, 10]}}}}")
    assert {toy.object for toy in bundle.manifest.toys} == {"car_001", "car_002"}
    assert {toy.category for toy in bundle.manifest.toys} == {"car"}
    model = mujoco.MjModel.from_xml_string(bundle.files["scene.xml"].decode(), assets=dict(bundle.files))
    for toy in bundle.manifest.toys:
        assert model.body(toy.body).mass[0] == pytest.approx(toy.mass_kg, rel=1e-6)
        assert f"`{toy.body}`: {toy.object}" in bundle.files["README.md"].decode()
    assert b"Toys4K (Stojanov et al. 2021)" in bundle.files["README.md"]


def test_the_root_is_seen_from_the_spec_and_knows_variables(toys4k, tmp_path, monkeypatch):
    monkeypatch.setenv("TOYS", str(tmp_path / "data"))
    toys = "{source: toys4k, subset: [ball_001], count: [1, 1], root: "
    bundles = [built(f"{{toys: {toys}{root}}}}}") for root in (toys4k, "$TOYS/toys4k_obj_files")]
    assert bundles[0].files["scene.xml"] == bundles[1].files["scene.xml"]


@pytest.mark.parametrize(
    ("subset", "said"),
    [
        ("cra", "scene.toys.subset[0]: 'cra' is neither a category nor an object in"),
        ("car_0001", "did you mean 'car_001'"),
        ("cup", "scene.toys: 'cup_001' (cup/cup_001/mesh.obj)"),
    ],
)
def test_what_is_wrong_with_an_object_is_said_by_name(toys4k, subset, said):
    assert said in refusal(f"{{toys: {{source: toys4k, root: {toys4k}, subset: [{subset}], count: [1, 1]}}}}")


HOSTILE = ("a b", "Würfel", "3d_cube", "<\"&'>", "赤い玉", "two\nlines", "\udcff", "--", "]]>", "toy1_main", "x" * 200)
"""Names of mesh files."""


def test_toys_from_files_of_any_name_have_safe_names_of_their_own_and_the_manifest_has_the_true_ones(tmp_path):
    folder = tmp_path / "my toys"
    folder.mkdir()
    for name in HOSTILE:
        (folder / f"{name}.stl").write_bytes(box_stl())
    bundle = built(f"{{toys: {{source: toys4k, root: '{folder}', count: [50, 50], size_cm: [1, 1]}}}}")
    assert {toy.object for toy in bundle.manifest.toys} == {
        *("a b", "Würfel", "3d_cube", "<\"&'>", "赤い玉", "two?lines", "?", "--", "]]>", "toy1_main", "x" * 200)
    }
    scene = etree.fromstring(bundle.files["scene.xml"])
    for kind in ("body", "geom", "mesh", "material", "joint", "freejoint"):
        names = [name for name in scene.xpath(f"//{kind}/@name") if name.startswith("toy")]
        assert len(set(names)) == len(names)
        assert all(re.fullmatch("[A-Za-z_][A-Za-z0-9_]*", name) for name in names)
    folder = mimoc.write_bundle(bundle, tmp_path / "out")
    assert mimoc.read_bundle(folder).manifest == bundle.manifest
    model = mimoc.make(folder).unwrapped.model
    assert all(model.body(toy.body).id > 0 and model.joint(toy.joint).id > 0 for toy in bundle.manifest.toys)


def test_a_toy_of_ones_own_is_named_as_its_file_is(tmp_path):
    (tmp_path / "Mein Würfel.stl").write_bytes(box_stl())
    (toy,) = built(
        f"{{toys: {{source: toys4k, root: {tmp_path}, subset: [Mein Würfel], count: [1, 1]}}}}"
    ).manifest.toys
    assert (toy.object, toy.category, toy.body) == ("Mein Würfel", "Mein Würfel", "toy1_Mein_Wurfel")
    assert "Toys4K" not in toy.source


def test_a_toy_in_capitals_gets_a_hint():
    assert "'Ball' is not one of mimoc's toys; did you mean 'ball'?" in refusal("{toys: {subset: [Ball]}}")


def test_a_root_that_is_not_there_is_pointed_at():
    said = refusal("{toys: {source: toys4k, root: nowhere}}")
    assert said.startswith("spec.yaml:4:38: scene.toys.root: ")
    assert "give the folder that Toys4K was unpacked to" in said


@pytest.mark.full
def test_a_users_pictures_come_up_in_rooms():
    Path("floors").mkdir()
    Image.fromarray(np.full((300, 300, 3), (250, 0, 250), np.uint8)).save("floors/pink.png")
    builder = building.builder
    Path("spec.yaml").write_text(f"{HEAD}scene: {{kind: room, textures: {{floor: floors}}}}\n")
    rooms = builder(mimoc.load_spec("spec.yaml"))
    named = [[name for name in rooms(seed).files if "pink" in name] for seed in range(40)]
    with_pink = [seed for seed, names in enumerate(named) if names]
    assert 1 <= len(with_pink) < 20
    picture = rooms(with_pink[0]).files[named[with_pink[0]][0]]
    assert max(Image.open(io.BytesIO(picture)).size) <= 256


def test_a_picture_that_is_none_is_pointed_at():
    Path("wall.png").write_text("no picture")
    said = refusal("{kind: room, textures: {wall: wall.png}}")
    assert said.startswith("spec.yaml:4:38: scene.textures.wall: ")
    assert "wall.png" in said


def test_the_build_says_so_where_toys_are_only_hulls(toys4k, monkeypatch):
    monkeypatch.setattr("mimoc.components.toys.toys4k.build.has_coacd", lambda: False)
    (note,) = built(f"{{toys: {{source: toys4k, root: {toys4k}, subset: [ball], count: [1, 1]}}}}").manifest.notes
    assert "pip install 'mimoc[toys]'" in note


def test_nothing_is_noted_of_mimocs_own_toys():
    assert built("{toys: {count: [1, 1]}}").manifest.notes == ()


def test_a_pose_that_a_task_makes_no_use_of_is_noted():
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "scene": {"pose": "sitting"}, "task": {"kind": "reach"}}
    (note,) = mimoc.build(mimoc.InfantSpec.model_validate(spec)).manifest.notes
    assert note == "task 'reach' has its own starting pose; 'scene.pose: sitting' has no effect"
    spec["scene"] = {"pose": "prone"}
    spec["task"] = {"kind": "rollover"}
    assert not mimoc.build(mimoc.InfantSpec.model_validate(spec)).manifest.notes
