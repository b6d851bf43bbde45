"""Every picture and mesh that was made to do harm is refused in one line."""

import os

import pytest
from fuzz import meshes, pictures
from fuzz.fuzzing import is_clear
from support.mesh_kinds import glb_of

from mimoc.base.errors import TextureError, ToyError
from mimoc.compiler.looks.wallpaper import read_textures
from mimoc.components.toys.toys4k.build import load_toy
from mimoc.components.toys.toys4k.dataset import find_toys

PNG, *_, TIFF = pictures.prepare(None)
PICTURES = {
    "2^62_pixels": pictures.resized(PNG, 2**31 - 1, 2**31 - 1),
    "a_line_of_2^31_pixels": pictures.resized(PNG, 2**31 - 1, 1),
    "25_megapixels": pictures.resized(PNG, 5000, 5000),
    "no_pixels": pictures.resized(PNG, 0, 16),
    "cut_off": PNG[: len(PNG) // 2],
    "header_only": PNG[:33],
    "another_format": TIFF,
    "empty": b"",
}
FAR = 2**40
MESHES = {
    "obj": b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999\n",
    "stl": bytes(80) + (2**32 - 1).to_bytes(4, "little"),
    "ply": b"ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty float x\nend_header\n",
    "glb": glb_of(
        {
            "asset": {"version": "2.0"},
            "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": FAR}],
            "bufferViews": [{"buffer": 0, "byteLength": FAR, "byteOffset": FAR}],
            "buffers": [{"byteLength": FAR, "uri": "../../etc/passwd"}],
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "nodes": [{"mesh": 0, "children": [0]}],
            "scenes": [{"nodes": [0]}],
        }
    ),
}


@pytest.mark.parametrize("name", PICTURES)
def test_a_crafted_picture_is_refused_in_one_line(name, tmp_path):
    (tmp_path / "picture.png").write_bytes(PICTURES[name])
    with pytest.raises(TextureError) as error:
        read_textures(tmp_path / "picture.png")
    assert is_clear(error.value)


def test_a_picture_that_is_a_pipe_is_not_waited_for(tmp_path):
    os.mkfifo(tmp_path / "picture.png")
    with pytest.raises(TextureError, match="is not a file"):
        read_textures(tmp_path)


@pytest.mark.parametrize("kind", MESHES)
def test_a_crafted_mesh_is_refused_in_one_line(kind, tmp_path, monkeypatch):
    monkeypatch.setattr(meshes.processing, "run_worker", meshes.read_here)
    (tmp_path / f"toy.{kind}").write_bytes(MESHES[kind])
    with pytest.raises(ToyError, match=r"^'toy' ") as error:
        load_toy(find_toys(tmp_path), "toy")
    assert is_clear(error.value)


def test_a_mesh_that_is_a_pipe_is_no_toy(tmp_path):
    os.mkfifo(tmp_path / "toy.obj")
    with pytest.raises(ToyError, match="contains no meshes"):
        find_toys(tmp_path)
