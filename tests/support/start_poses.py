"""How far an infant moves that begins an episode and does nothing, and how deep it is in what it touches.

`.ci/task poses` prints it for all poses, ages and bodies. What is asked of a start pose: hands and feet stay within
`MOVED_M` of where they are for `SECONDS`, without commands, and nothing is deeper than `DEPTH_M` in the floor,
in furniture or in the infant itself, at any time. Two things are held meanwhile, since they are not at rest but held:
what strength must hold in `sitting` and `standing` (`Pose.held`), as the hands of an adult would for the youngest, and
what it must hold at the start of a task (`HELD_BY_TASK`).
"""

import itertools
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from fnmatch import fnmatch
from typing import Any

import mujoco
import numpy as np

import mimoc
from mimoc.body.poses import POSES
from mimoc.bundle.model import load_model
from mimoc.fits.tables import load_tables

SECONDS = 2.0
MOVED_M, DEPTH_M = 0.01, 0.002
AGES_MONTHS = (0, 1, 2, 3, 4, 6, 7, 9, 12, 15, 18, 21, 24)
BETWEEN_MONTHS = (0.1, 0.4, 0.6, 0.9, 1.2, 1.7, 2.5, 3.5, 5, 8, 10.5, 16.5, 20)
"""Ages at which angles are interpolated."""
HELD_BY_TASK = {"selfbody": ("{side}_*",), "catch": ("{side}_*",), "standup": ("*",)}
"""Joints that strength holds: of an arm in the air, which touches nothing yet or offers its palm, and of an infant that
leans back and pulls at a rail."""
HELD_KGM2 = 1e6  # Armature of joints that strength holds.


@dataclass(frozen=True)
class Rest:
    spec: mimoc.InfantSpec
    pose: str
    moved_m: float  # Farthest that a hand or a foot is from where it was, after 2 s.
    part: str  # Which.
    start_depth_m: float  # Deepest contact at the start.
    depth_m: float  # Deepest contact in those 2 s.
    between: tuple[str, str]  # The geoms of that contact.

    @property
    def at_rest(self) -> bool:
        """Whether this is rest; between the ages of the table, twice as much is."""
        factor = 1 if self.spec.age_months in load_tables().postures.ages_months else 1.1
        return self.moved_m < factor * MOVED_M and self.depth_m < factor * DEPTH_M

    def __str__(self) -> str:
        spec = self.spec
        who = f"{spec.development} {spec.body.hands} {spec.age_months:g} months {self.pose}"
        moved = f"{self.moved_m * 100:5.2f} cm {self.part}"
        depths = f"{self.start_depth_m * 1e3:5.2f} mm, then {self.depth_m * 1e3:5.2f} mm {'-'.join(self.between)}"
        return f"{who:44} {moved:24} {depths}"


def spec_of(age_months: float, hands: str = "mitten", **sections: Any) -> mimoc.InfantSpec:
    body = {"hands": hands, "chest_joint": hands == "five_finger", "skin": False, **sections.pop("body", {})}
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "body": body, **sections}
    return mimoc.InfantSpec.model_validate(data)


def rests(spec: mimoc.InfantSpec) -> Iterator[Rest]:
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
    before, (start_depth_m, between) = data.xipos[ends], _deepest(model, data)
    depth_m = start_depth_m
    for _ in range(round(SECONDS / model.opt.timestep)):
        mujoco.mj_step(model, data)
        depth_m, between = max((depth_m, between), _deepest(model, data))
    moved_m = np.linalg.norm(data.xipos[ends] - before, axis=1)
    model.dof_armature[:] = armature
    part = model.body(ends[moved_m.argmax()]).name if ends else ""
    return Rest(spec, pose, float(moved_m.max(initial=0.0)), part, start_depth_m, depth_m, between)


def held_dofs(model: mujoco.MjModel, pose: str) -> list[int]:
    held = POSES[pose].held if pose in POSES else HELD_BY_TASK.get(pose, ())
    patterns = [each.format(side="*") for each in held]
    names = {model.joint(index).name.removeprefix("robot:"): index for index in range(model.njnt)}
    return [
        int(model.jnt_dofadr[index]) for name, index in names.items() if any(fnmatch(name, each) for each in patterns)
    ]


def _deepest(model: mujoco.MjModel, data: mujoco.MjData) -> tuple[float, tuple[str, str]]:
    """Return the depth of the deepest contact, and its geoms; toys and balls do not count."""
    own = np.isin(model.body_rootid, (0, model.body("hip").rootid[0]))
    depths_m = np.where(own[model.geom_bodyid[data.contact.geom]].all(axis=1), -data.contact.dist, 0.0)
    if not depths_m.size or depths_m.max() <= 0:
        return 0.0, ("", "")
    first, second = data.contact.geom[depths_m.argmax()]
    return float(depths_m.max()), (model.geom(first).name, model.geom(second).name)


def main() -> int:
    """Print what becomes of all poses, and return 1 if any is not at rest."""
    kinds = itertools.product(("maturing", "published"), ("mitten", "five_finger"), (False, True))
    failed = 0
    for (development, hands, chest_joint), age_months in itertools.product(kinds, AGES_MONTHS + BETWEEN_MONTHS):
        spec = spec_of(age_months, hands, development=development, body={"chest_joint": chest_joint})
        for found in rests(spec):
            failed += not found.at_rest
            print(found, "" if found.at_rest else "NOT AT REST", flush=True)
    print(f"{failed} are not at rest")
    return int(failed > 0)


if __name__ == "__main__":
    sys.exit(main())
