"""Find the angles at which infants of an age come to rest in their start poses, and write `data/postures.csv`.

    python sculpt/postures.py            # five minutes
    python sculpt/postures.py slumped    # only these poses; the others stay as they are

An infant without commands is laid down, sat or stood as `first_deg` says, while what strength must hold is held; a few
seconds later it rests. Left and right are made alike, and it begins again from there, until hands and feet stay where
they are.
"""

import csv
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from fnmatch import fnmatch
from itertools import product
from multiprocessing import Pool
from typing import Any

import mujoco
import numpy as np

from mimoc.body.poses import PITCH, POSES, SLUMP_MONTHS, SLUMPED, Pose, resting_state, slumped
from mimoc.body.tree import BodyTree
from mimoc.compiler.building import builder
from mimoc.compiler.model_check import compile_model
from mimoc.fits.tables import data_folder
from mimoc.schema.infant import InfantSpec

YOUNG_MONTHS = (0, 0.25, 0.5, 0.75, 1, 1.2499)
OLD_MONTHS = (1.25, 1.5, 2, 3, 4, 6, 9, 12, 18, 24)
"""Ages, in two series: each begins at its far end, and the next age where the one before came to rest. Where they meet,
arms that tone bent are stretched by their weight. Newborns sit as the others do, lest they tip over."""
ARM = ("shoulder_horizontal", "shoulder_ad_ab", "shoulder_rotation", "elbow")
MIDDLE = ("hip_bend1", "hip_bend2", "head_tilt", "head_swivel")
"""Joints of trunk and neck whose angles are looked for; the others stay straight. Of limbs, all are looked for."""
SECONDS, ROUNDS = 3.0, 12
STILL_M, STILL_SITTING_M = 0.001, 0.003
"""Hands and feet that move by less rest; hands creep on the thighs of a sitting infant."""
HELD_KGM2 = 1e6  # Armature of joints that are held.

Angles = dict[str, float]  # Degrees by joint; `{side}` stands for both sides.
LAP: Mapping[str, Angles] = {
    hands: dict(zip((f"{{side}}_{joint}" for joint in ARM), arm_deg, strict=True))
    for hands, arm_deg in {"mitten": (15, 5, -15, -90), "five_finger": (30, 5, 30, -115)}.items()
}
"""Arms above the thighs, onto which they fall."""
PUBLISHED_LAP: Mapping[str, Angles] = {
    hands: dict(zip((f"{{side}}_{joint}" for joint in ARM), arm_deg, strict=True))
    for hands, arm_deg in {"mitten": (40, 25, 0, -45), "five_finger": (40, 25, 30, -70)}.items()
}
"""Likewise of the published body, whose arms are nearer to the midline: from the lap its hands would slide."""
SLUMPED_ELBOW_DEG = -12.0
"""How much arms are lifted before an infant slumps farther than at the age before: they fall onto its thighs."""
FINGERS = "{side}_fingers"  # The joint of a mitten's fingers.
FIST_DEG = -145.0
"""How far newborns close their mittens before they sit, as they do on their backs; young infants, likewise less."""
SITTING_LIFT_DEG = {"{side}_elbow": -1.5}
LIFTS_DEG: Mapping[tuple[str, str, str], Angles] = {
    ("maturing", "sitting", "five_finger"): SITTING_LIFT_DEG,
    ("published", "sitting", "five_finger"): SITTING_LIFT_DEG,
    ("maturing", SLUMPED, "five_finger"): {**SITTING_LIFT_DEG, "{side}_shoulder_rotation": -2.0},
    ("maturing", SLUMPED, "mitten"): SITTING_LIFT_DEG,
    ("maturing", "standing", "mitten"): {"{side}_shoulder_rotation": -1.4, "{side}_shoulder_ad_ab": 0.3},
}
"""How much arms are lifted in the end, lest fingers sink in between ages, or in children of other sizes."""


def first_deg(name: str, development: str, hands: str) -> Angles:
    """Return how an infant is laid down, sat or stood; joints that are held stay so."""
    if name == "supine":
        return {"{side}_shoulder_ad_ab": 45}
    if name == "prone" and development == "published":
        return {"head_swivel": -70, "{side}_shoulder_ad_ab": 25}
    if name == "prone":
        return {"head_swivel": -70, "{side}_shoulder_ad_ab": 65, "{side}_shoulder_rotation": -85, "{side}_elbow": -75}
    if name in ("sitting", SLUMPED):
        return (PUBLISHED_LAP if development == "published" else LAP)[hands]
    return {}


Kind = tuple[str, str, bool, str]  # Law, hands, whether the chest has joints, and pose.
ROWS = ["development", "hands", "chest_joint", "pose", "joint"]


def main(names: Sequence[str] = ()) -> None:
    """Fit all poses, or those of some names, and write the table."""
    kinds: list[Kind] = [*product(("maturing", "published"), ("mitten", "five_finger"), (False, True), POSES)]
    kinds += product(("maturing",), ("mitten", "five_finger"), (False, True), (SLUMPED,))
    fitted = read_table() if names else {}
    wanted = [kind for kind in kinds if not names or kind[3] in names]
    with Pool(2) as pool:
        fitted |= zip(wanted, pool.map(all_ages, wanted, chunksize=1), strict=True)
    with (data_folder() / "postures.csv").open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow([*ROWS, *YOUNG_MONTHS, *OLD_MONTHS])
        for development, hands, chest_joint, pose in kinds:
            ages = fitted[development, hands, chest_joint, pose]
            if pose == SLUMPED:  # From then on, there is no difference.
                upright = fitted[development, hands, chest_joint, "sitting"]
                ages = [*ages, *({joint: angles[joint] for joint in ages[0]} for angles in upright[len(ages) :])]
            for joint in ages[0]:
                angles = [f"{angles_deg[joint]:g}" for angles_deg in ages]
                table.writerow([development, hands, str(chest_joint).lower(), pose, joint, *angles])


def read_table() -> dict[Kind, list[Angles]]:
    """Return the angles of all poses at all ages that are in the table."""
    fitted: dict[Kind, list[Angles]] = {}
    with (data_folder() / "postures.csv").open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            development, hands, chest_joint, pose, joint = (row.pop(name) for name in ROWS)
            ages = fitted.setdefault((development, hands, chest_joint == "true", pose), [{} for _ in row])
            for angles, value in zip(ages, row.values(), strict=True):
                angles[joint] = float(value)
    return fitted


def all_ages(kind: Kind) -> list[Angles]:
    """Return the angles of a pose at all ages at which it is not another one."""
    development, hands, chest_joint, name = kind
    body = {"hands": hands, "chest_joint": chest_joint, "skin": False}
    spec = {"mimoc": 1, "name": "x", "development": development, "body": body}
    if name == SLUMPED:
        ages_months = [age for age in OLD_MONTHS[::-1] if age < SLUMP_MONTHS[1]]
        old = series(spec, name, ages_months, series(spec, "sitting", [SLUMP_MONTHS[1]], {})[0])
    else:
        old = series(spec, name, OLD_MONTHS[::-1], {})
    young = series(spec, name, YOUNG_MONTHS, old[-1] if name in ("sitting", SLUMPED) else {})
    found = [*young, *reversed(old)]
    for joint, lift_deg in LIFTS_DEG.get((development, name, hands), {}).items():
        found = [{**angles, joint: round(angles[joint] + lift_deg, 1)} for angles in found]
    return found


def series(spec: dict[str, Any], name: str, ages_months: Sequence[float], before: Mapping[str, float]) -> list[Angles]:
    """Return the angles of a pose at some ages, and print by how much hands and feet move in the end."""
    found: list[Angles] = []
    for age_months in ages_months:
        made = builder(InfantSpec.model_validate({**spec, "age_months": age_months}))
        before = found[-1] if found else before
        free = {joint: angle for joint, angle in before.items() if not is_held(joint.format(side="right"), name)}
        first = {**first_deg(name, spec["development"], spec["body"]["hands"]), **free}
        if name == SLUMPED:
            first["{side}_elbow"] += SLUMPED_ELBOW_DEG
        if name == SLUMPED and age_months in YOUNG_MONTHS and spec["body"]["hands"] == "mitten":
            first[FINGERS] = FIST_DEG * (1 - age_months / SLUMP_MONTHS[1])
        angles, moved_m = fit(compile_model(made(0, check=False).files), made.tree, name, first)
        print(*spec["body"].values(), spec["development"], name, age_months, f"{moved_m * 1e3:.1f} mm", flush=True)
        found.append(angles)
    return found


def fit(model: mujoco.MjModel, tree: BodyTree, name: str, first: Angles) -> tuple[Angles, float]:
    """Return the angles of a pose at rest, and how far hands and feet move in the last round, in [m]."""
    held = [index for index in range(1, model.njnt) if is_held(_name(model, index), name)]
    model.dof_armature[model.jnt_dofadr[held]] = HELD_KGM2
    angles, moved_m = first, np.inf
    for _ in range(ROUNDS):
        angles, moved_m = settle(model, tree, name, angles)
        if moved_m < (STILL_SITTING_M if name in ("sitting", SLUMPED) else STILL_M):
            break
    w, _, y, _ = resting_state(tree, posed(tree, name, angles))[3:7]
    return {PITCH: round(np.degrees(2 * np.arctan2(y, w)), 1), **angles}, moved_m


def is_held(joint: str, name: str) -> bool:
    """Return whether strength holds a joint in a pose."""
    return any(fnmatch(joint, each.format(side="*")) for each in POSES["sitting" if name == SLUMPED else name].held)


def pose_at(name: str, age_months: float) -> Pose:
    """Return a pose at an age, without the angles that are looked for."""
    return slumped(age_months) if name == SLUMPED else POSES[name]


def posed(tree: BodyTree, name: str, angles: Angles) -> Pose:
    """Return a pose of a body with these angles."""
    pose = pose_at(name, tree.age_months)
    return replace(pose, angles_deg={**angles, **pose.angles_deg})


def settle(model: mujoco.MjModel, tree: BodyTree, name: str, angles: Angles) -> tuple[Angles, float]:
    """Return the angles after some seconds without commands, and how far hands and feet moved, in [m]."""
    data = mujoco.MjData(model)
    data.qpos[:] = resting_state(tree, posed(tree, name, angles))
    mujoco.mj_forward(model, data)
    ends = [index for index in range(model.nbody) if model.body(index).name.endswith(("_hand", "_foot"))]
    before = data.xipos[ends].copy()
    mujoco.mj_step(model, data, nstep=round(SECONDS / model.opt.timestep))
    moved_m = float(np.linalg.norm(data.xipos[ends] - before, axis=1).max())
    after = {
        _name(model, index): float(np.degrees(data.qpos[model.jnt_qposadr[index]])) for index in range(1, model.njnt)
    }
    found = {joint: round(angle, 1) + 0.0 for joint, angle in _alike(after, name)}
    kept = {joint: angle for joint, angle in found.items() if joint not in pose_at(name, tree.age_months).angles_deg}
    return kept, moved_m


def _alike(angles: Angles, name: str) -> Iterator[tuple[str, float]]:
    """Yield the angles that both sides take, and the mean of the two joints of the lumbar spine, which are coupled.

    They are the mean of both sides, but of a sitting infant those of the left one, lest hands sink into the thighs.
    """
    other = "left" if name in ("sitting", SLUMPED) else "right"
    bend = (angles["hip_bend1"] + angles["hip_bend2"]) / 2
    for joint, angle in {**angles, "hip_bend1": bend, "hip_bend2": bend}.items():
        side, _, limb = joint.partition("_")
        if side == "left" and not limb.startswith("eye"):
            yield f"{{side}}_{limb}", (angle + angles[f"{other}_{limb}"]) / 2
        elif joint in MIDDLE:
            yield joint, angle


def _name(model: mujoco.MjModel, joint: int) -> str:
    return model.joint(joint).name.removeprefix("robot:")


if __name__ == "__main__":
    main(sys.argv[1:])
