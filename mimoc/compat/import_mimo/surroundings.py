"""What a spec can say of the world of a MIMo scene: its kind, the starting pose, the task, the physics step."""

import math
from collections.abc import Iterator
from typing import Any

import mujoco
import numpy as np

from mimoc.compat.import_mimo.infant import HIP, Infant, held_parts

TARGET, RAIL_OR_CRIB, ROOM = "target", "crib", "room"
"""Bodies of MIMo's and BabyBench's scenes."""
STANDING_M = 0.2
"""Height of the hip above which an upright infant stands."""
UPRIGHT, LYING = 0.7, 0.85
"""Cosine of the angle up to which the trunk is upright, or lies."""
STEP_MS = 10.0
DEFAULT = {"step_ms": STEP_MS, "timestep_ms": 5.0}
ROOM_SIDES_M = (1.0, 20.0)


def notes_on_surroundings(sections: dict[str, Any]) -> Iterator[str]:
    """Yield notes on what the spec's world is besides that of the scene."""
    kind = sections["scene"]["kind"]
    if "task" in sections:
        task = sections["task"]["kind"]
        yield f"it is taken for MIMo's scene of the task '{task}', which in mimoc brings its own pose and objects"
    elif kind in (ROOM, RAIL_OR_CRIB):
        yield f"the spec's {kind} is one of mimoc's; that of the scene is in the file beside it"


def read_surroundings(infant: Infant, model: mujoco.MjModel) -> dict[str, Any]:
    """Return the sections `scene`, `control` and `task` of a spec; a task brings its own pose and held parts."""
    task = _task(infant, model)
    scene: dict[str, Any] = {"kind": "flat"} if task else _scene(infant, model)
    timestep_ms = round(1000 * model.opt.timestep, 6)
    steps = max(1, math.ceil(STEP_MS / timestep_ms - 1e-6))
    control = {"step_ms": round(steps * timestep_ms, 6), "timestep_ms": timestep_ms}
    return {"scene": scene, "control": {} if control == DEFAULT else control} | (
        {"task": {"kind": task}} if task else {}
    )


def _task(infant: Infant, model: mujoco.MjModel) -> str:
    """Return the task that MIMo has a scene like this for, empty if there is none: they are known by their bodies."""
    bodies = {model.body(body).name: body for body in range(model.nbody)}
    if TARGET in bodies and _moves_freely(model, bodies[TARGET]):
        falls = bool(np.any(model.opt.gravity))
        return "catch" if falls and infant.anatomy.hands == "five_finger" else "reach"
    rail = bodies.get(RAIL_OR_CRIB)
    return "standup" if rail and not np.any(model.body_parentid[1:] == rail) and model.body_geomnum[rail] > 1 else ""


def _moves_freely(model: mujoco.MjModel, body: int) -> bool:
    free = mujoco.mjtJoint.mjJNT_FREE
    return bool(model.body_jntnum[body] == 1 and model.jnt_type[model.body_jntadr[body]] == free)


def _scene(infant: Infant, model: mujoco.MjModel) -> dict[str, Any]:
    """Return the section `scene`, without objects, of which the spec language has no list."""
    bodies = {model.body(body).name: body for body in range(model.nbody)}
    section: dict[str, Any] = {"kind": "flat" if mujoco.mjtGeom.mjGEOM_PLANE in model.geom_type else "empty"}
    if RAIL_OR_CRIB in bodies:
        section = {"kind": "crib"}
    elif ROOM in bodies and (sides_m := _room_sides(model, bodies[ROOM])):
        section = {"kind": "room", "room": {"size_m": [[side, side] for side in sides_m]}}
    held = held_parts(infant)
    return {**section, "pose": _pose(model)} | ({"held": held} if held else {})


def _room_sides(model: mujoco.MjModel, room: int) -> list[float]:
    """Return depth, width and height between the walls of a room, empty if a spec cannot say these."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    walls = [geom for geom in range(model.ngeom) if model.geom_bodyid[geom] == room]
    sides = []
    for axis in (0, 1):
        inner = [abs(data.geom_xpos[wall][axis]) - model.geom_size[wall][axis] for wall in walls]
        far = [side for wall, side in zip(walls, inner, strict=True) if abs(data.geom_xpos[wall][axis]) > side > 0]
        sides.append(round(2 * float(min(far)), 3) if far else 0.0)
    top = max((float(data.geom_xpos[wall][2] + model.geom_size[wall][2]) for wall in walls), default=0.0)
    sides.append(round(top, 3))
    low, high = ROOM_SIDES_M
    return sides if all(low <= side <= high for side in sides) else []


def _pose(model: mujoco.MjModel) -> str:
    """Return the pose that is nearest to that of the scene, by the direction of the trunk."""
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    forward, up = (float(data.body(HIP).xmat.reshape(3, 3)[2, axis]) for axis in (0, 2))
    if forward > LYING:
        return "supine"
    if forward < -LYING:
        return "prone"
    return "standing" if up > UPRIGHT and data.body(HIP).xpos[2] > STANDING_M else "sitting"
