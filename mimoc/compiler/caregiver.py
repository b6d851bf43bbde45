"""A caregiver in the world of an infant: its bodies, where they are at the start, and its entry in the manifest."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np

from mimoc.base.geometry.adult import (
    FOREARM_M,
    HEAD_M,
    HIP_M,
    MOUTH_M,
    NECK_M,
    SHOULDER_M,
    SIDES,
    STATURE_M,
    TRUNK_M,
    UPPER_ARM_M,
    Adult,
    neck,
)
from mimoc.base.geometry.reach import Frame, leaning_pose
from mimoc.base.geometry.rotations import FloatArray, Quaternion, Vec3, quaternion_from_axis, quaternion_from_matrix
from mimoc.base.units import cm_to_m
from mimoc.body.kinematics import frames, frames_in_world
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree, on_head
from mimoc.compiler.looks.pictures import read_picture
from mimoc.compiler.mjcf.elements import SOLID, UNTINTED, UNTOUCHED, Rgba, WorldMaterial, WorldTexture
from mimoc.compiler.mjcf.world import Grip, ObjectBody, ObjectGeom, Persona
from mimoc.schema.body import ADULT_EXPRESSIONS
from mimoc.schema.caregiver import (
    ACTS,
    ActEntry,
    ActSpec,
    AnswersEntry,
    AnswersSpec,
    ArmEntry,
    CaregiverEntry,
    CaregiverSpec,
)

LEVEL: Quaternion = quaternion_from_axis((1.0, 0.0, 0.0), math.pi / 2)  # Turns z to the side.
STRAIGHT: Quaternion = (1.0, 0.0, 0.0, 0.0)
FINGERS = ("index", "middle", "ring", "little")
SOFT = (0.01, 1.0)  # `solref` of its contacts, softer than those of things: flesh; an assumption.


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
"""Colours of all parts but the face."""
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


HEAD = "head"
BETWEEN_EYES = (0.94, 0.0, -0.09)  # In half axes of the infant's head; the eyes are painted at that height.
PARTS = ("upper_arm", "forearm", "hand")
KICK_TRUNK = 0.25
"""How much farther from the hip a foot gets in a kick, by the length of the trunk: as `mimoc movement` counts kicks."""


@dataclass(frozen=True, slots=True)
class BuiltCaregiver:
    """A caregiver at its place."""

    persona: Persona  # All of it that stands in the MJCF.
    entry: CaregiverEntry
    origins: Mapping[str, Entry]  # Where its numbers come from, by key in `provenance.json`.


def place_caregiver(
    spec: CaregiverSpec | None, tree: BodyTree, qpos: Sequence[float], prefix: str = ""
) -> BuiltCaregiver | None:
    """Return the caregiver of a scene, if there is one, by an infant that starts in a state.

    The *prefix* is that of the infant's names.
    """
    if spec is None:
        return None
    scale = cm_to_m(spec.stature_cm) / STATURE_M
    head = next(geom for body in tree.bodies if body.name == HEAD for geom in body.geoms if geom.name == HEAD)
    x, y, z = MOUTH_M
    entry = CaregiverEntry(
        head=f"{NAME}_head",
        neck=f"{NAME}_neck",
        trunk=f"{NAME}_trunk",
        arms=(_arm("left"), _arm("right")),
        face=f"{NAME}_face",
        materials={name: face_material(name) for name in ADULT_EXPRESSIONS},
        mouth_m=(scale * x, scale * y, scale * z),
        infant_face_m=on_head(head, BETWEEN_EYES),
        place=spec.place,
        side=spec.side,
        distance_m=cm_to_m(spec.distance_cm),
        height_m=None if spec.height_cm is None else cm_to_m(spec.height_cm),
        scale=scale,
        expression=spec.expression,
        script=tuple(_act(act, tree) for act in spec.script),
        answers=spec.answers and _answers(spec.answers, tree),
    )
    placed = _frames(entry, frames_in_world(tree, qpos)[HEAD])
    bodies = tuple(_body(name, placed[name], geoms) for name, geoms in figure(scale).items())
    grips = tuple(Grip(arm.grip, arm.bodies[-1], prefix + tree.bodies[0].name) for arm in entry.arms)
    return BuiltCaregiver(Persona(bodies, materials(), faces(), grips), entry, _origins(spec, entry))


def settings_at(
    company: BuiltCaregiver | None, tree: BodyTree, qpos: Sequence[float]
) -> tuple[tuple[str, tuple[float, ...]], ...]:
    """Return what a keyframe says of the bodies of a caregiver by an infant in that state; nothing if there is none."""
    if company is None:
        return ()
    placed = _frames(company.entry, frames_in_world(tree, qpos)[HEAD])
    bodies = [_body(body.name, placed[body.name], ()) for body in company.persona.bodies]
    places, turns = (body.pos_m for body in bodies), (body.quat for body in bodies)
    return ("mpos", tuple(chain(*places))), ("mquat", tuple(chain(*turns)))


def _body(name: str, frame: Frame, geoms: tuple[ObjectGeom, ...]) -> ObjectBody:
    x, y, z = frame[0].tolist()
    return ObjectBody(name, (x, y, z), quaternion_from_matrix(frame[1]), geoms=geoms)


def _frames(entry: CaregiverEntry, head: Frame) -> dict[str, Frame]:
    adult, (origin_m, turn) = Adult(entry.scale), head
    face = origin_m + turn @ entry.infant_face_m, turn
    leaning = leaning_pose(adult.figure, face, entry.place, entry.side == "left", entry.distance_m, entry.height_m)
    placed = {entry.head: leaning.head, entry.neck: neck(leaning), entry.trunk: leaning.trunk}
    for side, arm in zip(SIDES, entry.arms, strict=True):
        parts = adult.arm(leaning.trunk, side, adult.resting(leaning.trunk, side))
        placed |= dict(zip(arm.bodies, parts, strict=True))
    return placed


def _arm(side: str) -> ArmEntry:
    upper_arm, forearm, hand = (f"{NAME}_{side}_{part}" for part in PARTS)
    return ArmEntry(bodies=(upper_arm, forearm, hand), grip=f"{NAME}_{side}_grip")


def _act(act: ActSpec, tree: BodyTree) -> ActEntry:
    about = act.about
    what = about.pop(ACTS[act.do].what or "", None)
    what = tree.home(what) if act.part is not None else what
    return ActEntry(at_ms=1000 * act.at_s, do=act.do, what=what, details=about, infant=act.infant)


def _answers(spec: AnswersSpec, tree: BodyTree) -> AnswersEntry:
    placed = frames(tree, {})
    ends = [_middle(placed, tree, limb) for limb in ("upper_arm", "upper_leg")]
    return AnswersEntry(
        to=spec.to,
        by=spec.by,
        probability=spec.probability,
        delay_ms=spec.delay_ms,
        pause_ms=spec.pause_ms,
        yoked_ms=tuple(1000 * at_s for at_s in spec.yoked_s),
        kick_m=KICK_TRUNK * float(np.linalg.norm(ends[0] - ends[1])),
    )


def _middle(placed: Mapping[str, Frame], tree: BodyTree, limb: str) -> FloatArray:
    """Return the middle between the roots of both limbs, or of the trunk's end where there are none."""
    roots = [placed[name][0] for side in SIDES if (name := f"{side}_{limb}") in placed]
    trunk = [body.name for body in tree.bodies if body.region == "trunk"]
    return np.mean(roots, axis=0) if roots else placed[trunk[-1 if limb == "upper_arm" else 0]][0]


def _origins(spec: CaregiverSpec, entry: CaregiverEntry) -> dict[str, Entry]:
    key = "caregiver"
    scale = "its stature, by 163 cm: lengths of head and arms are about those of the mean woman (ANSUR, Gordon et al. "
    face = "a point between the infant's eyes, in half axes of its head (.94, 0, -.09)"
    kick = f"{KICK_TRUNK:g} of the infant's trunk, from hips to shoulders, as kicks are counted by `mimoc movement`"
    rules: dict[str, tuple[float | Vec3, str, str, str]] = {
        "scale": (
            entry.scale,
            "",
            scale + "1989, from memory), others are assumptions",
            "spec.scene.caregiver.stature_cm",
        ),
        "infant_face_m": (entry.infant_face_m, "m", face, "geom.head.size"),
    }
    if entry.answers:
        rules["answers.kick_m"] = (entry.answers.kick_m, "m", kick, "measurements.crown_sole_length_cm")
    return {
        f"{key}.{name}": {"value": value, **({"unit": unit} if unit else {}), "rule": rule, "from": [source]}
        for name, (value, unit, rule, source) in rules.items()
    }
