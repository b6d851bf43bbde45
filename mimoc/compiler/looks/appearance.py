"""Textures and materials of an infant in the MJCF."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

from mimoc.anatomy.part import GeomType
from mimoc.compiler.looks.pictures import Colour, coloured_picture, inks_of
from mimoc.compiler.mjcf.elements import UNTINTED, Appearance, PrintedSkin, Rgba, WorldMaterial, WorldTexture
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
    pictures = {face_texture(name): (f"face_{name}", f"{face_shape}_{name}") for name in EXPRESSIONS}
    pictures |= {name: (name, name) for name in ("eye", "ear", *(["stripes"] if clothes in WITH_SHIRT else []))}
    return Appearance(
        textures=tuple(
            WorldTexture(name, f"assets/{file}.png", coloured_picture(painted, inks))
            for name, (file, painted) in pictures.items()
        ),
        materials=(*_body_materials(expression, inks), *_cloth_materials(clothes, inks)),
    )


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
    faces = {face_texture(name): f"skin_face_{name}" for name in EXPRESSIONS}
    # Those of clothes that it does not wear are there, too: many infants in one model have the same materials.
    shades = {material: material for material in SKIN_MATERIALS.values()}
    return Appearance(
        textures=tuple(
            replace(cube, name=HEAD_CUBE) if cube.name == shown else cube
            for cube in solid.textures
            if cube.name == shown or cube.name not in faces
        ),
        materials=(
            *(replace(item, texture=HEAD_CUBE) if item.name == "head" else item for item in solid.materials),
            *(_material(shade, UNTINTED, shade) for shade in shades),
        ),
        flat_textures=tuple(
            WorldTexture(name, f"assets/{picture}.png", coloured_picture(picture, inks))
            for name, picture in {**faces, **shades}.items()
        ),
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


def _material(
    name: str, rgba: Rgba, texture: str | None = None, specular: float = 0.1, shininess: float = 0.2
) -> WorldMaterial:
    """Return a material of skin or cloth, which are dull."""
    return WorldMaterial(name, rgba, texture, specular=specular, shininess=shininess)


def _body_materials(expression: str, inks: Mapping[str, Colour]) -> tuple[WorldMaterial, ...]:
    return (
        _material("skin", _rgba(inks["skin"])),
        _material("head", UNTINTED, face_texture(expression)),
        *(_material(face_material(name), UNTINTED, face_texture(name)) for name in EXPRESSIONS),
        _material("ear", UNTINTED, "ear"),
        *(_material(f"eye_{side}", UNTINTED, "eye", specular=0.5, shininess=0.8) for side in ("left", "right")),
    )


WITH_SHIRT: tuple[Clothes, ...] = ("bodysuit", "shirt_and_trousers")
WITH_LEGS: tuple[Clothes, ...] = ("trousers", "shirt_and_trousers")
"""Clothes that cover the trunk and the arms, and those that cover the legs."""


def _cloth_materials(clothes: Clothes, inks: Mapping[str, Colour]) -> tuple[WorldMaterial, ...]:
    has_shirt, skin = clothes in WITH_SHIRT, _rgba(inks["skin"])
    seat = _rgba(inks["shirt" if clothes == "bodysuit" else "trousers"])
    trunk = (UNTINTED, "stripes") if has_shirt else (skin, None)
    return (
        *(_material(f"top_{part}", *trunk) for part in ("down", "middle", "up")),
        _material("top_sleeve", _rgba(inks["shirt"]) if has_shirt else skin),
        *(_material(f"pants_{part}", seat) for part in ("down", "up")),
        _material("pants_leg", seat if clothes in WITH_LEGS else skin),
    )


def _rgba(colour: Colour) -> Rgba:
    red, green, blue = colour
    return (round(red / 255, 4), round(green / 255, 4), round(blue / 255, 4), 1.0)
