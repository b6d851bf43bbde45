"""Textures and materials of a caregiver."""

from mimoc.compiler.looks.pictures import read_picture
from mimoc.compiler.mjcf.furniture import UNTINTED, Rgba, WorldMaterial, WorldTexture
from mimoc.schema.expressions import ADULT_EXPRESSIONS

NAME = "caregiver"
SKIN: Rgba = (0.9098, 0.7451, 0.6353, 1.0)
COLOURS: dict[str, Rgba] = {
    "skin": SKIN,
    "hair": (0.27, 0.18, 0.12, 1.0),
    "jumper": (0.22, 0.42, 0.40, 1.0),
    "trousers": (0.24, 0.26, 0.33, 1.0),
}
"""Of all but the face."""
GLOW = 0.25
"""Emission of skin, in place of the light that comes back from floor and infant onto a face that looks down."""


def material(what: str) -> str:
    """Return the name of the material of a part."""
    return f"{NAME}_{what}"


def faces() -> tuple[WorldTexture, ...]:
    """Return the texture of each facial expression, a cube of six sides."""
    return tuple(
        WorldTexture(f"{NAME}_face_{name}", f"assets/{NAME}_face_{name}.png", read_picture(f"adult_face_{name}"))
        for name in ADULT_EXPRESSIONS
    )


def materials() -> tuple[WorldMaterial, ...]:
    """Return all materials."""
    return (
        *(WorldMaterial(material(what), rgba, emission=GLOW * (what == "skin")) for what, rgba in COLOURS.items()),
        *(WorldMaterial(name, UNTINTED, name, emission=GLOW) for name in map(face_material, ADULT_EXPRESSIONS)),
    )


def face_material(expression: str) -> str:
    """Return the name of the material of an expression."""
    return f"{NAME}_face_{expression}"
