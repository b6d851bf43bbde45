"""Textures and materials of an infant in the MJCF."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType

from mimoc.anatomy.part import GeomType
from mimoc.compiler.looks.pictures import Colour, coloured_picture, inks_of
from mimoc.compiler.mjcf.furniture import UNTINTED, Appearance, Material, PrintedSkin, Rgba, Texture
from mimoc.schema.body import EXPRESSIONS, Clothes, LooksSpec

AVERAGE = LooksSpec()  # What an infant looks like of which nothing is said.

GRID_LAYOUT = "RLUDFB"
"""The sides of a cube texture in its picture, two rows of three, by MuJoCo's letters (`templates/infant.xml.j2`)."""
HEAD_CUBE = "head_solid"  # Texture of the head's solid under a skin.


@dataclass(frozen=True, slots=True)
class HeadFeature:
    """A visual geom of the head, without mass or contacts. Sizes are in head radii."""

    name: str
    type: GeomType  # `sphere` or `ellipsoid`.
    size: tuple[float, ...]  # Radius, or the three half-axes.
    pos: tuple[float, float, float]  # Centre, from the centre of the head in its half axes; x forward, y left, z up.
    euler_deg: tuple[float, float, float]  # Successive rotations about x, y and z, in [deg].
    material: str


HEAD_FEATURES = (
    HeadFeature("left_ear", "ellipsoid", (0.13, 0.055, 0.19), (-0.05, 1.02, -0.13), (0, 10, -35), "ear"),
    HeadFeature("right_ear", "ellipsoid", (0.13, 0.055, 0.19), (-0.05, -1.02, -0.13), (0, 10, 35), "ear"),
    HeadFeature("nose", "ellipsoid", (0.10, 0.11, 0.085), (0.925, 0, -0.275), (0, 0, 0), "skin"),
)
"""The nose and the ears, so that a head is recognisable from the side; the rest of the face is in the texture."""


def add_materials(
    expression: str,
    looks: LooksSpec = AVERAGE,
    clothes: Clothes = "shirt_and_trousers",
    *,
    round_head: bool = True,
) -> Appearance:
    """Return the textures and materials of an infant with an expression, and those of the other expressions.

    A head that is not round, a sphere, is as much narrower as children's are.
    """
    inks = inks_of(looks, clothes)
    face_shape = "face_round" if round_head else "face"
    faces = {name: Texture(face_texture(name), f"assets/face_{name}.png") for name in EXPRESSIONS}
    names = ("eye", "ear", "stripes") if clothes in WITH_SHIRT else ("eye", "ear")
    others = [Texture(name, f"assets/{name}.png") for name in names]
    assets = {
        **{texture.file: coloured_picture(f"{face_shape}_{name}", inks) for name, texture in faces.items()},
        **{texture.file: coloured_picture(texture.name, inks) for texture in others},
    }
    materials = (*_body_materials(expression, inks), *_cloth_materials(clothes, inks))
    return Appearance((*faces.values(), *others), materials, MappingProxyType(assets))


SKIN_MATERIALS = {"body": "skin_body", "shirt": "skin_shirt", "trousers": "skin_trousers", "hair": "skin_hair"}
"""Material of each layer of a skin; that of the head is the expression."""


def dress_skin(
    expression: str,
    layers: tuple[str, ...],
    looks: LooksSpec = AVERAGE,
    clothes: Clothes = "shirt_and_trousers",
    *,
    round_head: bool = True,
) -> Appearance:
    """Return the textures and materials of an infant with layers of skin; its solids show one expression only."""
    inks = inks_of(looks, clothes)
    solid = add_materials(expression, looks, clothes, round_head=round_head)
    shown = face_texture(expression)
    faces = {name: Texture(face_texture(name), f"assets/skin_face_{name}.png") for name in EXPRESSIONS}
    # Those of clothes that it does not wear are there, too: many infants in one model have the same materials.
    shades = {name: Texture(material, f"assets/{material}.png") for name, material in SKIN_MATERIALS.items()}
    cubes = tuple(
        replace(cube, name=HEAD_CUBE) if cube.name == shown else cube
        for cube in solid.textures
        if cube.name == shown or cube.name not in {face.name for face in faces.values()}
    )
    return Appearance(
        textures=cubes,
        materials=(
            *(replace(item, texture=HEAD_CUBE) if item.name == "head" else item for item in solid.materials),
            *(Material(shade.name, UNTINTED, shade.name) for shade in shades.values()),
        ),
        assets=MappingProxyType(
            {
                **{cube.file: solid.assets[cube.file] for cube in cubes},
                **{texture.file: coloured_picture(f"skin_face_{name}", inks) for name, texture in faces.items()},
                **{shade.file: coloured_picture(shade.name, inks) for shade in shades.values()},
            }
        ),
        flat_textures=(*faces.values(), *shades.values()),
        skins=tuple(
            PrintedSkin(name, f"assets/{name}.skn", SKIN_MATERIALS.get(name, face_material(expression)))
            for name in layers
        ),
    )


def face_texture(expression: str) -> str:
    """Return the name of the texture that shows an expression; the neutral one is the one that MIMo's code looks up."""
    return f"tex_head_{'default' if expression == 'neutral' else expression}"


def face_material(expression: str) -> str:
    """Return the name of the material of an expression."""
    return f"head_{expression}"


def _body_materials(expression: str, inks: Mapping[str, Colour]) -> tuple[Material, ...]:
    return (
        Material("skin", _rgba(inks["skin"])),
        Material("head", UNTINTED, face_texture(expression)),
        *(Material(face_material(name), UNTINTED, face_texture(name)) for name in EXPRESSIONS),
        Material("ear", UNTINTED, "ear"),
        *(Material(f"eye_{side}", UNTINTED, "eye", specular=0.5, shininess=0.8) for side in ("left", "right")),
    )


WITH_SHIRT: tuple[Clothes, ...] = ("bodysuit", "shirt_and_trousers")
WITH_LEGS: tuple[Clothes, ...] = ("trousers", "shirt_and_trousers")
"""Clothes that cover the trunk and the arms, and those that cover the legs."""


def _cloth_materials(clothes: Clothes, inks: Mapping[str, Colour]) -> tuple[Material, ...]:
    has_shirt, skin = clothes in WITH_SHIRT, _rgba(inks["skin"])
    seat = _rgba(inks["shirt" if clothes == "bodysuit" else "trousers"])
    trunk = (UNTINTED, "stripes") if has_shirt else (skin, None)
    return (
        *(Material(f"top_{part}", *trunk) for part in ("down", "middle", "up")),
        Material("top_sleeve", _rgba(inks["shirt"]) if has_shirt else skin),
        *(Material(f"pants_{part}", seat) for part in ("down", "up")),
        Material("pants_leg", seat if clothes in WITH_LEGS else skin),
    )


def _rgba(colour: Colour) -> Rgba:
    red, green, blue = colour
    return (round(red / 255, 4), round(green / 255, 4), round(blue / 255, 4), 1.0)
