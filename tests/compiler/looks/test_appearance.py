import mujoco
import numpy as np
import pytest

from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_average
from mimoc.compiler.looks.appearance import GRID_LAYOUT, HEAD_FEATURES, add_materials, face_material, face_texture
from mimoc.compiler.mjcf.furniture import Appearance
from mimoc.schema.expressions import EXPRESSIONS

REFERENCE_MATERIALS = {
    "pants_down",
    "pants_up",
    "pants_leg",
    "top_down",
    "top_middle",
    "top_up",
    "top_sleeve",
    "head",
    "eye_left",
    "eye_right",
    "skin",
}


def mjcf(appearance: Appearance) -> str:
    """Return one sphere for each material."""
    textures = "".join(
        f'<texture name="{t.name}" type="cube" file="{t.file}" gridsize="2 3" gridlayout="{GRID_LAYOUT}"/>'
        for t in appearance.textures
    )
    materials = "".join(
        f'<material name="{m.name}" rgba="{" ".join(map(str, m.rgba))}"'
        + (f' texture="{m.texture}"/>' if m.texture else "/>")
        for m in appearance.materials
    )
    geoms = "".join(f'<geom size="1" material="{m.name}"/>' for m in appearance.materials)
    return f"<mujoco><asset>{textures}{materials}</asset><worldbody>{geoms}</worldbody></mujoco>"


def test_every_material_of_the_reference_body_exists():
    names = [material.name for material in add_materials("neutral").materials]
    assert set(names) >= REFERENCE_MATERIALS
    assert len(set(names)) == len(names)


def test_geoms_and_features_name_materials_that_exist():
    names = {material.name for material in add_materials("neutral").materials}
    geoms = grow_average(18, assemble("mitten", False)).geoms.values()
    assert {geom.material for geom in geoms} == REFERENCE_MATERIALS
    assert {feature.material for feature in HEAD_FEATURES} <= names


@pytest.mark.parametrize("expression", EXPRESSIONS)
def test_every_texture_has_its_file_and_every_file_its_texture(expression):
    appearance = add_materials(expression)
    textures = {texture.name for texture in appearance.textures}
    assert {material.texture for material in appearance.materials if material.texture} == textures
    assert {texture.file for texture in appearance.textures} == set(appearance.assets)
    assert sum(map(len, appearance.assets.values())) < 250_000


def test_only_the_face_depends_on_the_expression():
    """All faces are there to change to; which one the head starts with is the material's."""
    happy, sad = add_materials("happy"), add_materials("sad")
    assert (happy.assets, happy.textures) == (sad.assets, sad.textures)
    differ = [pair for pair in zip(happy.materials, sad.materials, strict=True) if pair[0] != pair[1]]
    assert [(a.name, a.texture, b.texture) for a, b in differ] == [("head", "tex_head_happy", "tex_head_sad")]


def test_there_is_a_material_for_each_expression_of_the_language():
    shown = {material.name: material.texture for material in add_materials("neutral").materials}
    assert {name: shown[face_material(name)] for name in EXPRESSIONS} == {
        name: face_texture(name) for name in EXPRESSIONS
    }


def test_no_two_faces_look_alike():
    pictures = [add_materials("neutral").assets[f"assets/face_{name}.png"] for name in EXPRESSIONS]
    assert len(set(pictures)) == len(EXPRESSIONS) == 9


def test_mujoco_reads_the_pictures_as_they_were_drawn():
    appearance = add_materials("neutral")
    model = mujoco.MjModel.from_xml_string(mjcf(appearance), dict(appearance.assets))
    assert model.ntex == len(appearance.textures)
    cube = model.texture("tex_head_default")
    assert cube.type[0] == mujoco.mjtTexture.mjTEXTURE_CUBE
    assert cube.height[0] == 6 * cube.width[0]


def test_mujoco_reads_the_pictures_without_warnings(capfd):
    appearance = add_materials("neutral")
    data = mujoco.MjData(mujoco.MjModel.from_xml_string(mjcf(appearance), dict(appearance.assets)))
    assert not any(warning.number for warning in data.warning)
    assert capfd.readouterr().err == ""


def test_ears_mirror_each_other():
    left, right = (next(f for f in HEAD_FEATURES if f.name == name) for name in ("left_ear", "right_ear"))
    assert left.size == right.size
    assert np.allclose(np.multiply(left.pos, [1, -1, 1]), right.pos)
    assert np.allclose(np.multiply(left.euler_deg, [-1, 1, -1]), right.euler_deg)


def test_features_sit_on_the_surface_of_the_head():
    """Sunk in, so that no gap shows, and sticking out, so that they show."""
    for feature in HEAD_FEATURES:
        distance = float(np.linalg.norm(feature.pos))
        assert distance - max(feature.size) < 1 < distance + max(feature.size)
