"""Which hinges of an infant a recording can tell of, and which of them turn together."""

from collections.abc import Sequence

import mujoco
import numpy as np

from mimoc.motion.body_points import BodyPoint
from mimoc.movement.retargeting.skeleton import Hinges, carrying

NEVER = "eye", "fingers", "toe", "_ff_", "_mf_", "_rf_", "_lf_", "_th_"
"""Parts of names of hinges that no point tells of."""


def hinges_of(model: mujoco.MjModel, points: Sequence[BodyPoint]) -> Hinges:
    """Return the hinges between the root and some points, parents first.

    The lumbar hinges of two bodies that MIMo couples by tendons of (nearly) fixed length turn by one unknown.
    """
    bodies, followers = carrying(model, [point.body for point in points]), _followers(model)
    names, ids, columns, factors = [], [], [], []
    for joint in range(1, model.njnt):
        name = model.joint(joint).name
        hinge = model.jnt_type[joint] == mujoco.mjtJoint.mjJNT_HINGE
        if not hinge or int(model.jnt_bodyid[joint]) not in bodies or any(part in name for part in NEVER):
            continue
        leader, factor = followers.get(joint, (joint, 1.0))
        if leader not in ids and leader != joint:
            continue
        if leader == joint:
            names.append(name)
        ids.append(joint)
        columns.append(names.index(model.joint(leader).name))
        factors.append(factor)
    return Hinges(tuple(names), np.array(ids, np.intp), np.array(columns, np.intp), np.array(factors))


def combined_limits(model: mujoco.MjModel, hinges: Hinges) -> tuple[np.ndarray, np.ndarray]:
    """Return the limits of sums of unknowns that tendons set: factors, shape (m, u), and bounds, shape (m,)."""
    factors, bounds = [], []
    place = dict(zip(hinges.ids.tolist(), hinges.column.tolist(), strict=True))
    followers = _followers(model)
    for tendon in range(model.ntendon):
        joints, weights = _terms(model, tendon)
        if model.tendon_limited[tendon] and all(j in place and j not in followers for j in joints):
            if set(joints) & {leader for leader, _ in followers.values()}:
                continue
            row = np.zeros(len(hinges.names))
            row[[place[j] for j in joints]] = weights
            factors.append(row)
            bounds.append(float(np.abs(model.tendon_range[tendon]).min()))
    return np.array(factors).reshape(-1, len(hinges.names)), np.array(bounds)


def _followers(model: mujoco.MjModel) -> dict[int, tuple[int, float]]:
    """Return the hinges that tendons of nearly fixed length turn with another: which other, and by how much."""
    followers = {}
    for tendon in range(model.ntendon):
        joints, weights = _terms(model, tendon)
        if len(joints) == 2 and model.tendon_limited[tendon] and np.ptp(model.tendon_range[tendon]) < 0.1:
            followers[joints[1]] = (joints[0], -weights[0] / weights[1])
    return followers


def _terms(model: mujoco.MjModel, tendon: int) -> tuple[list[int], list[float]]:
    """Return the joints and factors of a tendon that is a sum of angles; none of another."""
    span = slice(model.tendon_adr[tendon], model.tendon_adr[tendon] + model.tendon_num[tendon])
    if (model.wrap_type[span] != mujoco.mjtWrap.mjWRAP_JOINT).any():
        return [], []
    return model.wrap_objid[span].tolist(), model.wrap_prm[span].tolist()
