"""What a spec says of skin, hair, eyes and clothes, and what becomes of it."""

import io
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path
from typing import Any, get_args

import mujoco
import numpy as np
import pytest
from PIL import Image

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.base.errors import SpecError
from mimoc.body.grow import grow_average
from mimoc.bundle.model import load_model
from mimoc.bundle.world import load_world_model
from mimoc.compiler.explain import explain
from mimoc.compiler.looks.appearance import (
    GRID_LAYOUT,
    HEAD_FEATURES,
    SKIN_MATERIALS,
    add_materials,
    dress_skin,
    face_material,
    face_texture,
)
from mimoc.compiler.looks.pictures import (
    EYES,
    HAIR,
    INKS,
    SKINS,
    coloured_picture,
    inks_of,
    mixed,
    mixtures,
    read_picture,
    with_palette,
)
from mimoc.compiler.mjcf.elements import Appearance
from mimoc.compiler.variants import SpecVariants, at_age
from mimoc.render.portrait import row_of
from mimoc.schema import InfantSpec, LooksSpec
from mimoc.schema.body import EXPRESSIONS, Clothes, EyeColour, HairColour, SkinTone

TONES: tuple[SkinTone, ...] = get_args(SkinTone)
OUTFITS: tuple[Clothes, ...] = get_args(Clothes)
LUMINANCE = (0.2126, 0.7152, 0.0722)  # Of red, green and blue (ITU-R BT.709).


def spec(age_months: float = 9, looks: dict[str, Any] | None = None, **keys: Any) -> InfantSpec:
    return InfantSpec.model_validate(
        {"mimoc": 1, "name": "infant", "age_months": age_months, "body": {"looks": looks or {}}, **keys}
    )


def inks(clothes: Clothes = "shirt_and_trousers", **looks: Any) -> dict[str, Any]:
    return inks_of(LooksSpec(**looks), clothes)


def chunks(png: bytes) -> Iterator[tuple[bytes, bytes]]:
    """Yield the kind and the whole of each chunk of a PNG."""
    start = 8
    while start < len(png):
        end = start + 12 + int.from_bytes(png[start : start + 4], "big")
        yield png[start + 4 : start + 8], png[start:end]
        start = end


def pixels(png: bytes) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(png)).convert("RGB"), float)


def brightness(colour: Any) -> float:
    return float(np.dot(LUMINANCE, colour))


def test_the_page_names_every_choice_and_default():
    page = (Path(__file__).parents[3] / "docs" / "looks.md").read_text(encoding="utf-8")
    rows = {row.split("`")[1]: row for row in page.splitlines() if row.startswith("| `")}
    for key, names in {"skin": TONES, "hair": HAIR, "eyes": EYES, "clothes": OUTFITS}.items():
        choices, default = rows[key].split("|")[2:4]
        assert re.findall("`([a-z_]+)`", choices) == list(names)
        assert (getattr(LooksSpec(), key) or "bodysuit") in default


def test_every_name_of_the_language_has_its_colours():
    assert tuple(SKINS) == TONES
    assert tuple(HAIR) == get_args(HairColour)
    assert tuple(EYES) == get_args(EyeColour)


@pytest.mark.parametrize("ink", ["skin", "blush", "lip", "shade"])
def test_skin_is_darker_from_name_to_name(ink):
    luminances = [brightness(inks(skin=tone)[ink]) for tone in TONES]
    assert all(lighter > 1.05 * darker for lighter, darker in pairwise(luminances))


@pytest.mark.parametrize("tone", TONES)
def test_lips_are_redder_than_the_skin_around_them_and_creases_are_darker(tone):
    colours = inks(skin=tone)
    red, green, blue = colours["skin"]
    lip_red, lip_green, lip_blue = colours["lip"]
    assert lip_red / (lip_green + lip_blue) > 1.1 * red / (green + blue)
    assert brightness(colours["shade"]) < 0.75 * brightness(colours["skin"])


def test_colours_are_whole_numbers_that_a_palette_can_hold():
    for tone in TONES:
        for clothes in OUTFITS:
            values = np.array(list(inks_of(LooksSpec(skin=tone), clothes).values()))
            assert np.array_equal(values, values.astype(np.uint8))


def test_a_mixture_is_the_mean_of_its_inks_rounded_half_up():
    amounts = np.zeros((2, len(INKS)), np.uint8)
    amounts[0, INKS.index("pupil")], amounts[1, [INKS.index("pupil"), INKS.index("glint")]] = 255, (100, 100)
    assert mixed(amounts, inks()).tolist() == [[22, 18, 20], [139, 137, 138]]


@pytest.mark.parametrize("name", ["skin_body", "skin_face_neutral", "face_round_happy", "eye", "ear"])
def test_only_the_palette_of_a_picture_depends_on_looks(name):
    light, dark = (coloured_picture(name, inks(skin=tone, eyes="green", hair="black")) for tone in ("light", "dark"))
    pairs = zip(chunks(light), chunks(dark), strict=True)
    differing = [kind for (kind, before), (_, after) in pairs if before != after]
    assert differing == [b"PLTE"]
    assert light != read_picture(name)


@pytest.mark.parametrize("name", sorted(mixtures()))
def test_the_default_looks_are_those_that_are_painted(name):
    assert coloured_picture(name, inks()) == read_picture(name)


def test_what_has_no_palette_of_inks_stays_as_it_was_painted():
    assert coloured_picture("floor_cork", inks()) == read_picture("floor_cork")


def test_a_palette_is_replaced_colour_by_colour():
    png = read_picture("skin_trousers")
    grey = np.full((len(mixtures()["skin_trousers"]), 3), 77, np.uint8)
    assert np.all(pixels(with_palette(png, grey)) == 77)


@pytest.mark.parametrize("tone", TONES)
def test_skin_is_as_bright_as_its_name_says_in_pictures_and_on_solids(tone):
    model = load_model(mimoc.build(spec(looks={"skin": tone})))
    expected = np.array(inks(skin=tone)["skin"])
    assert model.mat("skin").rgba[:3] * 255 == pytest.approx(expected, abs=0.02)
    texture = model.tex("skin_body").id
    first = model.tex_adr[texture]
    assert np.abs(model.tex_data[first : first + 3].astype(float) - expected).max() < 4


@pytest.mark.parametrize(
    ("age_months", "weeks", "expected"),
    [
        (0, None, "bodysuit"),
        (5.9, None, "bodysuit"),
        (6, None, "shirt_and_trousers"),
        (24, None, "shirt_and_trousers"),
        (7, 32, "bodysuit"),
        (8, 32, "shirt_and_trousers"),
    ],
)
def test_clothes_are_by_the_age_since_term(age_months, weeks, expected):
    infant = spec(age_months, impairments={"gestation_weeks": weeks} if weeks else None)
    bundle = mimoc.build(infant)
    assert infant.clothes == bundle.manifest.child.clothes == expected
    assert spec(age_months, {"clothes": "nappy"}).clothes == "nappy"


def test_a_growing_infant_keeps_its_clothes_and_the_same_child_built_at_another_age_changes_them():
    young = spec(5)
    assert at_age(young, 9).clothes == at_age(young, 9, checked=False).clothes == "bodysuit"
    assert young.with_(age_months=9).clothes == "shirt_and_trousers"
    variants = SpecVariants(young)
    before, after = load_model(variants.original), variants(9, 0).model
    assert np.array_equal(before.skin_face, after.skin_face)
    assert np.array_equal(before.mat_rgba, after.mat_rgba)
    assert np.array_equal(before.tex_data, after.tex_data)


def test_an_infant_of_other_looks_is_not_cast_from_the_first_ones_pictures():
    first, second = SpecVariants(spec(looks={"skin": "light"})), SpecVariants(spec(looks={"skin": "dark"}))
    variant = second.own_like(first)
    assert np.array_equal(variant.model.tex_data, load_model(second.original).tex_data)
    assert not np.array_equal(variant.model.tex_data, load_model(first.original).tex_data)


@pytest.mark.parametrize("clothes", OUTFITS)
def test_solids_are_bare_where_clothes_leave_them_bare(clothes):
    materials = {item.name: item for item in add_materials("neutral", LooksSpec(skin="tan"), clothes).materials}
    skin = materials["skin"].rgba
    bare = {name for name, item in materials.items() if item.rgba == skin and item.texture is None} - {"skin"}
    trunk, legs = {"top_down", "top_middle", "top_up", "top_sleeve"}, {"pants_leg"}
    expected = {"bodysuit": legs, "trousers": trunk, "nappy": trunk | legs}
    assert bare == expected.get(clothes, set())


def test_a_spec_is_refused_with_the_name_that_was_meant():
    with pytest.raises(SpecError) as refusal:
        spec(looks={"skin": "lite", "hair": "blonde", "eyes": "gray", "clothes": "nappies", "shoes": "red"})
    messages = [problem.message for problem in refusal.value.problems]
    for meant in ("light", "blond", "grey", "nappy"):
        assert any(f"did you mean '{meant}'?" in message for message in messages), meant
    assert any(message.startswith("unknown key") for message in messages)


@pytest.fixture(scope="module")
def world():
    """Return a world of two infants of different looks and a third like the first."""
    dark, light = spec(looks={"skin": "dark", "eyes": "brown"}), spec(4, {"skin": "light", "eyes": "green"})
    return mimoc.build_world({"anna": dark, "ben": light, "cleo": dark})


def test_infants_of_a_world_have_their_looks_and_share_pictures_that_are_equal(world):
    model = load_world_model(world)
    for name, tone, eyes in (("anna", "dark", "brown"), ("ben", "light", "green"), ("cleo", "dark", "brown")):
        colours = inks("bodysuit" if name == "ben" else "shirt_and_trousers", skin=tone, eyes=eyes)
        assert model.mat(f"{name}_skin").rgba[:3] * 255 == pytest.approx(colours["skin"], abs=0.02)
        first = model.tex_adr[model.tex(f"{name}_skin_body").id]
        assert np.abs(model.tex_data[first : first + 3] - np.array(colours["skin"], float)).max() < 4
    pictures = {name for name in world.files if "skin_body" in name}
    assert pictures == {"assets/skin_body.png", "assets/ben_skin_body.png"}


def test_infants_in_a_row_have_their_looks():
    bundles = [mimoc.build(spec(looks={"skin": tone})) for tone in ("dark", "light")]
    model = row_of(bundles, None).data.model
    first, second = (_picture(model, f"{number}: skin_body") for number in (0, 1))
    assert first.mean() < 0.6 * second.mean()


def _picture(model: mujoco.MjModel, texture: str) -> np.ndarray:
    index = model.tex(texture).id
    size = model.tex_width[index] * model.tex_height[index] * model.tex_nchannel[index]
    return model.tex_data[model.tex_adr[index] : model.tex_adr[index] + size]


def test_looks_can_be_explained():
    bundle = mimoc.build(spec(4, {"skin": "tan", "hair": "red", "eyes": "hazel"}))
    for key, value in (("skin", "tan"), ("hair", "red"), ("eyes", "hazel")):
        assert explain(bundle, f"spec.body.looks.{key}").lines[0] == value
    clothes = explain(bundle, "child.clothes")
    assert clothes.lines[0] == "bodysuit"
    assert [source.key for source in clothes.sources] == ["spec.age_months"]
    asked = explain(mimoc.build(spec(4, {"clothes": "nappy"})), "child.clothes")
    assert asked.sources[0].key == "spec.body.looks.clothes"


def test_infants_in_all_clothes_have_the_same_materials():
    """Otherwise they could not live in worlds of one model on a device."""
    names = {clothes: [item.name for item in dressed(clothes).materials] for clothes in OUTFITS}
    assert all(materials == names["nappy"] for materials in names.values())
    assert set(SKIN_MATERIALS.values()) < set(names["nappy"])


def dressed(clothes: Clothes) -> Appearance:
    layers = {"nappy": ("body", "trousers", "head"), "trousers": ("body", "trousers", "head")}
    return dress_skin("neutral", layers.get(clothes, ("body", "shirt", "head")), LooksSpec(), clothes)


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
