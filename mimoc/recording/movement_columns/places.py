"""Columns of where things are: keypoints, parts of the body with their velocities, and what the eyes look at."""

import math
import re
from collections.abc import Sequence

import mujoco
import numpy as np

from mimoc.recording.movement_columns.anatomy import Parts
from mimoc.recording.movement_columns.column import NO_COLUMNS, Column, FloatArray, Group, Values
from mimoc.runtime.infant import Infant

AXES = "xyz"
SIDES = {"L": "left_", "R": "right_"}
BODY = "body"
"""The name of all parts together."""
TRUNK = "trunk"
_LABEL = re.compile(r"([LR](?=[A-Z]))?([A-Z]\w*)")
_CAPITAL = re.compile(r"(?<=[a-z])(?=[A-Z])")


def keypoint_name(label: str) -> str:
    """Return the name of a keypoint of BODY_25: `right_big_toe` for `BODY_25:RBigToe`."""
    match = _LABEL.fullmatch(label.rpartition(":")[2])
    side, point = match.groups() if match else (None, label)
    return SIDES.get(side or "", "") + _CAPITAL.sub("_", point).lower()


def bind_keypoints(env: Infant) -> Group:
    """Return where the keypoints of `InfantEnv.keypoints` are, to the bit; NaN for those of missing limbs."""
    labels = env.manifest.keypoints
    sites = np.array([mujoco.mj_name2id(env.model, mujoco.mjtObj.mjOBJ_SITE, label) for label in labels], np.intp)

    def values(fields: Sequence[FloatArray], moments: object) -> Values:
        places_m = fields[0][:, sites]
        places_m[:, sites < 0] = np.nan
        return Values(places_m.reshape(len(places_m), -1))

    columns = [column for label in labels for column in _place(keypoint_name(label), *_KEYPOINT)]
    return Group(tuple(columns), values, (env.data.site_xpos,))


def bind_parts(env: Infant) -> Group:
    """Return position, velocity and speed of the centres of mass of hands, feet, head, trunk and the whole body.

    A part of bodies i with the masses m_i has its centre of mass at sum m_i x_i / sum m_i, which moves with
    sum m_i v_i / sum m_i, where v_i = v + w x (x_i - c) from the spatial velocity (w, v) of the body about c, the
    centre of mass of the infant, as MuJoCo's `cvel` gives it.
    """
    parts, model = Parts.of(env), env.model
    inside, bodies, root = _bodies_of_parts(parts), parts.bodies, int(model.body_rootid[parts.bodies[0]])
    shares = np.array([np.isin(bodies, of_part) * model.body_mass[bodies] for of_part in inside.values()])
    shares /= shares.sum(axis=1, keepdims=True)

    columns = tuple(column for name in inside for column in _motion(name))

    def values(fields: Sequence[FloatArray], moments: object) -> Values:
        places_m, spatial, about_m = fields[0][:, bodies], fields[1][:, bodies], fields[2][:, None]
        velocities = spatial[..., 3:] + np.cross(spatial[..., :3], places_m - about_m)
        motion = np.empty((len(places_m), len(shares), 7))
        motion[..., :3], motion[..., 3:6] = shares @ places_m, shares @ velocities
        motion[..., 6] = np.linalg.norm(motion[..., 3:6], axis=-1)
        return Values(motion.reshape(len(places_m), -1))

    return Group(columns, values, (env.data.xipos, env.data.cvel, env.data.subtree_com[root]))


def bind_objects(env: Infant) -> Group:
    """Return position, velocity and speed of the centre of mass of the outermost body of each object of the spec.

    It moves with v = v' + w x (x - c), where (w, v') is its spatial velocity about c, the centre of mass of the object.
    """
    entries = env.simulation.bundle.manifest.objects
    if not entries:
        return NO_COLUMNS
    bodies = np.array([env.model.body(item.body).id for item in entries], np.intp)

    def values(fields: Sequence[FloatArray], moments: object) -> Values:
        places_m, spatial, about_m = (field[:, bodies] for field in fields)
        velocities = spatial[..., 3:] + np.cross(spatial[..., :3], places_m - about_m)
        speeds = np.linalg.norm(velocities, axis=-1, keepdims=True)
        return Values(np.concatenate([places_m, velocities, speeds], axis=-1).reshape(len(places_m), -1))

    columns = [column for item in entries for column in _motion(f"object_{item.name}", _OBJECT)]
    return Group(tuple(columns), values, (env.data.xipos, env.data.cvel, env.data.subtree_com))


def bind_gaze(env: Infant) -> Group:
    """Return where the line of sight first meets something that is not the head: of both eyes, or of the only one.

    It begins midway between the eyes' cameras, and points along the mean of the directions in which they look.
    """
    model, head = env.model, env.manifest.anatomy.head
    eyes = np.array([model.camera(eye.camera).id for eye in env.manifest.anatomy.eyes], np.intp)
    if not len(eyes):
        return NO_COLUMNS
    parts, geom = Parts.of(env), np.zeros(1, np.int32)
    data, cam_xpos, cam_xmat = env.data, env.data.cam_xpos, env.data.cam_xmat
    mean = np.bincount(eyes, minlength=model.ncam) / len(eyes)
    own_head = env.manifest.of_infant(head) if head else ""
    skipped = parts.things.index(own_head) if own_head in parts.things else -1
    excluded = model.body(head).id if head else -1

    def moment() -> tuple[FloatArray, FloatArray, float, int]:
        start_m, towards = mean @ cam_xpos, (-mean @ cam_xmat)[2::3]  # Cameras look along -z; it need not be a unit.
        times, thing, begin_m = 0.0, skipped, start_m
        while thing == skipped:  # The eyes are bodies of their own, through which it may pass.
            further = mujoco.mj_ray(model, data, begin_m, towards, None, 1, excluded, geom)
            if further < 0:
                return start_m, towards, math.nan, -1
            times, thing = times + float(further) + _BEYOND, int(parts.thing_of_geom[int(geom[0])])
            begin_m = start_m + times * towards
        return start_m, towards, times - _BEYOND, thing

    def values(fields: object, moments: Sequence[tuple[FloatArray, FloatArray, float, int]]) -> Values:
        start_m, towards, times = (np.array([item[index] for item in moments]) for index in range(3))
        length, times = np.linalg.norm(towards, axis=1, keepdims=True), times[:, None]
        numbers = np.hstack([start_m + times * towards, times * length, towards / length])
        return Values(numbers, [(parts.things[thing] if thing >= 0 else "",) for *_, thing in moments])

    return Group(_GAZE, values, moment=moment)


_BEYOND = 1e-6
"""How far behind a surface of the eyes the line of sight goes on, about [m]."""
_RAY = "MuJoCo's mj_ray from between the cameras of the eyes"
_SIGHT = "mean line of sight of the eyes"
_GAZE = (
    *(
        Column(
            f"gaze_{axis}_m", "m", f"{axis} of where the {_SIGHT} first meets something; empty if nothing", source=_RAY
        )
        for axis in AXES
    ),
    Column("gaze_distance_m", "m", "distance from between the eyes to there; empty if there is nothing", source=_RAY),
    *(
        Column(
            f"gaze_direction_{axis}", "", f"{axis} of the unit vector along the {_SIGHT}", source="MuJoCo's cam_xmat"
        )
        for axis in AXES
    ),
    Column(
        "gaze_at",
        "",
        "what it meets: a part of the own body or of another infant, a toy, a fixed thing",
        source=_RAY,
        is_text=True,
    ),
)


def _bodies_of_parts(parts: Parts) -> dict[str, list[int]]:
    anatomy, inside = parts.manifest.anatomy, dict[str, list[int]]()
    for name in parts.whole:
        own = parts.manifest.of_infant(name)
        inside[own] = [body for body, part in parts.part_of_body.items() if part == own]
    if anatomy.trunk:
        inside[TRUNK] = [parts.model.body(name).id for name in anatomy.trunk]
    return {**inside, BODY: list(parts.part_of_body)}


_KEYPOINT = "keypoint of BODY_25, {}", "OpenPose's BODY_25; MuJoCo's site_xpos"
_CENTRE = "centre of mass of the {}", "MuJoCo's xipos and cvel, weighted by mass"
_OBJECT = "centre of mass of the {}, of its outermost body", "MuJoCo's xipos and cvel"


def _place(name: str, what: str, source: str) -> list[Column]:
    about = what.format(name.replace("_", " "))
    return [Column(f"{name}_{axis}_m", "m", f"{axis} of the {about}", source=source) for axis in AXES]


def _motion(name: str, centre: tuple[str, str] = _CENTRE) -> list[Column]:
    what, source = centre[0].format(name.replace("_", " ")), centre[1]
    return [
        *_place(name, *centre),
        *(
            Column(f"{name}_velocity_{axis}_m_s", "m/s", f"{axis} of the velocity of the {what}", source=source)
            for axis in AXES
        ),
        Column(f"{name}_speed_m_s", "m/s", f"length of the velocity of the {what}", source=source),
    ]
