"""The solids of a caregiver: head with face and hair, neck, trunk, and two arms with hands."""

import math
from collections.abc import Mapping
from dataclasses import replace

from mimoc.base.geometry.adult import FOREARM_M, HEAD_M, HIP_M, NECK_M, SHOULDER_M, SIDES, TRUNK_M, UPPER_ARM_M
from mimoc.base.geometry.rotations import Quaternion, Vec3, quaternion_from_axis
from mimoc.compiler.looks.pictures import read_picture
from mimoc.compiler.mjcf.furniture import SOLID, UNTINTED, UNTOUCHED, Rgba, WorldMaterial, WorldTexture
from mimoc.compiler.mjcf.world import ObjectGeom
from mimoc.schema.expressions import ADULT_EXPRESSIONS

LEVEL: Quaternion = quaternion_from_axis((1.0, 0.0, 0.0), math.pi / 2)
"""Turns z to the side."""
STRAIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)
FINGERS = ("index", "middle", "ring", "little")
SOFT = (0.01, 1.0)
"""`solref` of its contacts, softer than those of things: flesh; an assumption."""


def figure(scale: float) -> Mapping[str, tuple[ObjectGeom, ...]]:
    """Return the geoms of each body by its name, in the frame of the body."""
    parts = {"head": _head(), "neck": _neck(), "trunk": _trunk()}
    for side in SIDES:
        parts |= {
            f"{side}_upper_arm": (_limb(f"{side}_upper_arm", "jumper", 0.042, UPPER_ARM_M),),
            f"{side}_forearm": (_limb(f"{side}_forearm", "jumper", 0.034, FOREARM_M),),
            f"{side}_hand": _hand(side),
        }
    return {f"{NAME}_{body}": tuple(_scaled(geom, scale) for geom in geoms) for body, geoms in parts.items()}


def _geom(
    name: str,
    kind: str,
    size_m: tuple[float, ...],
    looks: str,
    pos_m: Vec3 = (0.0, 0.0, 0.0),
    quat: Quaternion = STRAIGHT,
    touches: bool = True,
) -> ObjectGeom:
    bits = SOLID if touches else UNTOUCHED
    return ObjectGeom(
        name=f"{NAME}_{name}",
        type=kind,
        material=looks,
        sizes=(("size", size_m),),
        pos_m=pos_m,
        quat=quat,
        contype=bits,
        conaffinity=bits,
        friction=(1.0, 0.005, 0.0002),
        group=0 if touches else 1,
        solref=SOFT,
    )


def _head() -> tuple[ObjectGeom, ...]:
    """Return the skull with the face, ears, nose, and hair that reaches to the neck."""
    x, y, z = HEAD_M
    hair, skin = material("hair"), material("skin")
    ears = (
        _geom(f"{side}_ear", "ellipsoid", (0.018, 0.008, 0.03), skin, (-0.005, sign * 0.074, -0.012), touches=False)
        for side, sign in zip(SIDES, (1.0, -1.0), strict=True)
    )
    return (
        _geom("face", "ellipsoid", (x, y, z), face_material("neutral")),
        _geom("nose", "ellipsoid", (0.016, 0.012, 0.02), skin, (0.094, 0.0, -0.016), touches=False),
        *ears,
        _geom("hair", "ellipsoid", (0.094, 0.081, 0.1), hair, (-0.022, 0.0, 0.026), touches=False),
        _geom("hair_behind", "ellipsoid", (0.05, 0.074, 0.1), hair, (-0.066, 0.0, -0.04), touches=False),
    )


def _neck() -> tuple[ObjectGeom, ...]:
    return (_geom("neck", "capsule", (0.052, math.hypot(*NECK_M) / 2), material("skin"), (0.0, 0.0, 0.07)),)


def _trunk() -> tuple[ObjectGeom, ...]:
    """Return shoulders, chest and hips, below the base of the neck."""
    jumper = material("jumper")
    return (
        _geom("shoulders", "capsule", (0.055, SHOULDER_M[1] - 0.03), jumper, (0.0, 0.0, -0.045), LEVEL),
        _geom("chest", "ellipsoid", (HIP_M, 0.155, 0.21), jumper, (0.0, 0.0, -0.2)),
        _geom("hips", "ellipsoid", (HIP_M, 0.165, 0.14), material("trousers"), (0.0, 0.0, -TRUNK_M + 0.08)),
    )


def _limb(name: str, looks: str, radius_m: float, length_m: float) -> ObjectGeom:
    """Return a part of an arm, along z from its near joint to the far one."""
    return _geom(name, "capsule", (radius_m, length_m / 2), material(looks), (0.0, 0.0, length_m / 2))


def _hand(side: str) -> tuple[ObjectGeom, ...]:
    """Return palm, fingers and thumb of a hand along z, whose palm looks along x; the thumb is on the inner side."""
    skin, inner = material("skin"), (-1.0 if side == "left" else 1.0)
    palm = _geom(f"{side}_palm", "box", (0.012, 0.038, 0.045), skin, (0.0, 0.0, 0.052))
    lengths_m = (0.07, 0.078, 0.072, 0.056)
    fingers = (
        _geom(
            f"{side}_{finger}",
            "capsule",
            (0.0085, length_m / 2 - 0.0085),
            skin,
            (0.012, inner * (0.029 - 0.0193 * number), 0.095 + length_m / 2 - 0.01),
            quaternion_from_axis((0.0, 1.0, 0.0), math.radians(18)),
        )
        for number, (finger, length_m) in enumerate(zip(FINGERS, lengths_m, strict=True))
    )
    turn = quaternion_from_axis((1.0, 0.0, 0.0), math.radians(-40 * inner))
    thumb = _geom(f"{side}_thumb", "capsule", (0.0105, 0.024), skin, (0.014, inner * 0.05, 0.062), turn)
    return (palm, *fingers, thumb)


def _scaled(geom: ObjectGeom, scale: float) -> ObjectGeom:
    x, y, z = geom.pos_m
    sizes = tuple((name, tuple(scale * number for number in numbers)) for name, numbers in geom.sizes)
    return replace(geom, sizes=sizes, pos_m=(scale * x, scale * y, scale * z))


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
