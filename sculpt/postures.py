"""Find the angles at which infants of an age come to rest in their start poses, and write `data/postures.csv`.

    python sculpt/postures.py

An infant without commands is laid down, sat or stood as `GUESSES_DEG` says, while what strength must hold is held; a
few seconds later it rests. What is left and right is made alike, and the whole is repeated from there until hands and
feet stay where they are.
"""

import csv
from collections.abc import Iterator, Mapping
from dataclasses import replace
from fnmatch import fnmatch

import mujoco
import numpy as np

from mimoc.body.poses import POSES, Pose, resting_state
from mimoc.body.tree import BodyTree
from mimoc.compiler.building import builder
from mimoc.compiler.model_check import compile_model
from mimoc.fits.tables import data_folder
from mimoc.schema.infant import InfantSpec

AGES_MONTHS = (0, 1, 2, 3, 4, 6, 9, 12, 18, 24)
GUESSES_DEG: Mapping[str, Mapping[str, float]] = {
    "supine": {"{side}_shoulder_ad_ab": 45},
    "prone": {"{side}_shoulder_ad_ab": 65, "{side}_shoulder_rotation": -85, "{side}_elbow": -75},
    "sitting": {"{side}_shoulder_ad_ab": 10},
    "standing": {},
}
FREE = (
    *("hip_bend1", "hip_bend2", "head_tilt"),
    *("shoulder_horizontal", "shoulder_ad_ab", "shoulder_rotation", "elbow", "hand1", "hand2", "hand3", "fingers"),
    *("hip1", "hip2", "hip3", "knee", "foot1", "foot2", "foot3", "toes"),
)
"""Joints whose angles are looked for; those without a side by their names, of the others the mean of both."""
SECONDS, ROUNDS = 4.0, 12
STILL_M = 0.001
"""Hands and feet that move by less rest."""
HELD_KGM2 = 1e6
"""Armature of joints that are held."""


def main() -> None:
    """Fit all poses, print by how much hands and feet move in the end, and write the table."""
    rows = []
    for development in ("maturing", "published"):
        for name in POSES:
            angles: dict[str, list[float]] = {}
            for age_months in AGES_MONTHS:
                settled, moved_m = fit(development, name, age_months)
                print(f"{development:10} {name:9} {age_months:3} months: {moved_m * 1e3:5.1f} mm", flush=True)
                for joint, angle_deg in settled.items():
                    angles.setdefault(joint, []).append(angle_deg)
            rows += [[development, name, joint, *(f"{angle:g}" for angle in of_ages)] for joint, of_ages in angles.items()]
    with (data_folder() / "postures.csv").open("w", encoding="utf-8", newline="") as file:
        csv.writer(file, lineterminator="\n").writerows([["development", "pose", "joint", *AGES_MONTHS], *rows])


def fit(development: str, name: str, age_months: float) -> tuple[dict[str, float], float]:
    """Return the angles of a pose at rest, in degrees, and how far hands and feet move in the last round, in [m]."""
    body = {"hands": "mitten", "skin": False}
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "development": development, "body": body}
    made = builder(InfantSpec.model_validate(data))
    model = compile_model(made(0, check=False).files)
    held(model, POSES[name])
    wanted = replace(POSES[name], angles_deg={**GUESSES_DEG[name], **POSES[name].angles_deg})
    for _ in range(ROUNDS):
        settled, moved_m = settle(model, made.tree, wanted)
        wanted = replace(wanted, angles_deg={**settled, **POSES[name].angles_deg})
        if moved_m < STILL_M:
            break
    return settled, moved_m


def held(model: mujoco.MjModel, pose: Pose) -> None:
    """Hold the joints of a model that strength holds in a pose."""
    for joint in range(1, model.njnt):
        name = model.joint(joint).name.removeprefix("robot:")
        if any(fnmatch(name, each.format(side="*")) for each in pose.held):
            model.dof_armature[model.jnt_dofadr[joint]] = HELD_KGM2


def settle(model: mujoco.MjModel, tree: BodyTree, wanted: Pose) -> tuple[dict[str, float], float]:
    """Return the angles after some seconds without commands, in degrees, and how far hands and feet moved, in [m]."""
    data = mujoco.MjData(model)
    data.qpos[: model.nq] = resting_state(tree, wanted)
    mujoco.mj_forward(model, data)
    ends = [index for index in range(model.nbody) if model.body(index).name.endswith(("_hand", "_foot"))]
    before = data.xipos[ends].copy()
    mujoco.mj_step(model, data, nstep=round(SECONDS / model.opt.timestep))
    moved_m = float(np.linalg.norm(data.xipos[ends] - before, axis=1).max())
    return dict(_angles_deg(model, data, wanted)), moved_m


def _angles_deg(model: mujoco.MjModel, data: mujoco.MjData, wanted: Pose) -> Iterator[tuple[str, float]]:
    def of(joint: str) -> float:
        return float(np.degrees(data.qpos[model.joint(f"robot:{joint}").qposadr[0]]))

    for joint in FREE:
        if joint.startswith("hip_bend"):
            pattern, angle = joint, (of("hip_bend1") + of("hip_bend2")) / 2
        elif joint.startswith("head"):
            pattern, angle = joint, of(joint)
        else:
            pattern, angle = f"{{side}}_{joint}", (of(f"left_{joint}") + of(f"right_{joint}")) / 2
        yield pattern, round(angle, 1) + 0.0


if __name__ == "__main__":
    main()
