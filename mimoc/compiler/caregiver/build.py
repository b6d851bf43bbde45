"""A caregiver in the world of an infant: its bodies, where they are at the start, and its entry in the manifest."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np

from mimoc.base.geometry.adult import MOUTH_M, SIDES, STATURE_M, Adult, neck
from mimoc.base.geometry.leaning import Frame, lean
from mimoc.base.geometry.rotations import FloatArray, Vec3, quaternion_from_matrix
from mimoc.base.units import cm_to_m
from mimoc.body.head_surface import on_head
from mimoc.body.kinematics import frames, frames_in_world
from mimoc.body.origins import Entry
from mimoc.body.tree import BodyTree
from mimoc.compiler.caregiver.figure import NAME, face_material, faces, figure, materials
from mimoc.compiler.mjcf.world import Grip, ObjectBody, ObjectGeom, Persona
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
from mimoc.schema.expressions import ADULT_EXPRESSIONS

HEAD = "head"
BETWEEN_EYES = (0.94, 0.0, -0.09)
"""In half axes of the infant's head; the eyes are painted at that height."""
PARTS = ("upper_arm", "forearm", "hand")
KICK_TRUNK = 0.25
"""How much farther from the hip a foot gets in a kick, by the length of the trunk: as `mimoc movement` counts kicks."""


@dataclass(frozen=True, slots=True)
class BuiltCaregiver:
    """A caregiver at its place."""

    persona: Persona
    """All of it that stands in the MJCF."""
    entry: CaregiverEntry
    origins: Mapping[str, Entry]
    """Where its numbers come from, by key in `provenance.json`."""


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
    """Return where each body is at the start, by its name, with resting hands."""
    adult, (origin_m, turn) = Adult(entry.scale), head
    face = origin_m + turn @ entry.infant_face_m, turn
    leaning = lean(adult.figure, face, entry.place, entry.side == "left", entry.distance_m, entry.height_m)
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
