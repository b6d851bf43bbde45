"""How far an infant moves that begins an episode and does nothing, and how deep it is in the floor, things and itself."""

from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatch
from typing import Any

import mujoco
import numpy as np

import mimoc
from mimoc.body.poses import POSES
from mimoc.bundle.model import load_model

SECONDS = 2.0
HELD_KGM2 = 1e6
"""Armature of joints that strength holds."""


@dataclass(frozen=True)
class Rest:
    """What became of a start pose."""

    spec: mimoc.InfantSpec
    pose: str
    moved_m: float
    """Farthest that a hand or a foot is from where it was, after 2 s."""
    part: str
    """Which."""
    start_depth_m: float
    """Deepest contact at the start."""
    depth_m: float
    """Deepest contact in those 2 s."""
    between: tuple[str, str]
    """The geoms of that contact."""

    def __str__(self) -> str:
        """Return a row of a table."""
        spec = self.spec
        who = f"{spec.development} {spec.body.hands} {spec.age_months:g} months {self.pose}"
        moved = f"{self.moved_m * 100:5.2f} cm {self.part}"
        depths = f"{self.start_depth_m * 1e3:5.2f} mm, then {self.depth_m * 1e3:5.2f} mm {'-'.join(self.between)}"
        return f"{who:44} {moved:24} {depths}"


def spec_of(age_months: float, hands: str = "mitten", **sections: Any) -> mimoc.InfantSpec:
    """Return the spec of an infant without senses."""
    body = {"hands": hands, "chest_joint": hands == "five_finger", "skin": False, **sections.pop("body", {})}
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "body": body, **sections}
    return mimoc.InfantSpec.model_validate(data)


def rests(spec: mimoc.InfantSpec) -> Iterator[Rest]:
    """Yield what becomes of each pose of a spec's bundle."""
    model = load_model(mimoc.build(spec))
    for key in range(model.nkey):
        yield rest(spec, model, model.key(key).name)


def rest(spec: mimoc.InfantSpec, model: mujoco.MjModel, pose: str) -> Rest:
    """Return what becomes of a pose without commands, its joints held that strength must hold."""
    armature = model.dof_armature.copy()
    model.dof_armature[held_dofs(model, pose)] = HELD_KGM2
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_forward(model, data)
    ends = [index for index in range(model.nbody) if model.body(index).name.endswith(("_hand", "_foot"))]
    before, start_depth_m, depth_m, between = data.xipos[ends], _depth_m(data), 0.0, ("", "")
    for _ in range(round(SECONDS / model.opt.timestep)):
        mujoco.mj_step(model, data)
        if _depth_m(data) > depth_m:
            depth_m, deepest = _depth_m(data), data.contact.geom[data.contact.dist.argmin()]
            between = (model.geom(deepest[0]).name, model.geom(deepest[1]).name)
    moved_m = np.linalg.norm(data.xipos[ends] - before, axis=1)
    model.dof_armature[:] = armature
    part = model.body(ends[moved_m.argmax()]).name if ends else ""
    return Rest(spec, pose, float(moved_m.max(initial=0.0)), part, start_depth_m, depth_m, between)


def held_dofs(model: mujoco.MjModel, pose: str) -> list[int]:
    """Return the degrees of freedom of the joints that strength holds in a pose."""
    patterns = [each.format(side="*") for each in POSES[pose].held] if pose in POSES else []
    names = {model.joint(index).name.removeprefix("robot:"): index for index in range(model.njnt)}
    return [
        int(model.jnt_dofadr[index]) for name, index in names.items() if any(fnmatch(name, each) for each in patterns)
    ]


def _depth_m(data: mujoco.MjData) -> float:
    return float(-data.contact.dist.min(initial=0.0))
