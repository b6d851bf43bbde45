"""Infants that have just grown, brought out of what their new size makes them reach into."""

from collections.abc import Mapping, Sequence

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.model import TOUCH_M
from mimoc.runtime.sense import FloatArray, IntArray

LEFT_M = 1e-4
"""Penetration that is left, so that what supports the infant goes on to do so; as in the poses of `body.poses`."""
ROUNDS = 40
"""Most times that it is moved; some are enough."""
UPWARDS = 0.1
"""Least vertical part of a contact's normal at which lifting helps."""
FARTHEST = 0.2
"""What a joint turns by in one round at most, in [rad], and what moves freely moves by, in [m]."""
AT_LIMITS = 5
"""Most times in a round that joints which reach the end of their range leave the rest to others."""
DAMPING = 1e-5
"""Of contacts that contradict each other, relative to the largest."""

Mask = npt.NDArray[np.bool_]
Depths = Mapping[tuple[int, int], float]
"""The deepest penetration of each pair of bodies that touch, in [m]; the world is a body, too."""


def resolve_penetrations(
    model: mujoco.MjModel, data: mujoco.MjData, root_bodies: Sequence[str], fixed: IntArray, before: Depths
) -> None:
    """Lift infants by as much as each sinks into what it is on, and part them from themselves and what they touch.

    Joints, and what lies around, give way by as little as needed, weighted by inertia; nothing else is pushed deeper
    into anything than it was.
    """
    roots = [model.body(name).id for name in root_bodies]
    heights = model.jnt_qposadr[model.body_jntadr[roots]] + 2
    root_of = model.body_rootid[model.geom_bodyid]
    yielding = model.dof_invweight0.copy()
    yielding[fixed] = 0.0
    for _ in range(ROUNDS):
        mujoco.mj_fwdPosition(model, data)
        touching, depths_m = root_of[data.contact.geom], -data.contact.dist
        pairs = model.geom_bodyid[data.contact.geom].tolist()
        usual_m = [before.get((first, second), 0.0) for first, second in pairs]
        usual_m = np.where(np.isin(touching, roots).any(axis=1), 0.0, usual_m)
        if not (depths_m > np.maximum(usual_m, TOUCH_M)).any():
            return
        lifts_m = [_lift_m(data, touching == root, depths_m) for root in roots]
        if any(lifts_m):
            data.qpos[heights] += lifts_m
        else:
            excess_m = np.maximum(depths_m - np.maximum(usual_m, LEFT_M), 0.0)
            _part(model, data, np.flatnonzero(depths_m > 0), excess_m, yielding)


def depths_of(model: mujoco.MjModel, data: mujoco.MjData) -> Depths:
    """Return how deep each pair of bodies penetrate each other in a state whose contacts have been computed."""
    depths: dict[tuple[int, int], float] = {}
    pairs = model.geom_bodyid[data.contact.geom].tolist()
    for (first, second), distance in zip(pairs, data.contact.dist.tolist(), strict=True):
        depths[first, second] = max(depths.get((first, second), 0.0), -distance)
    return depths


def clip_angles(model: mujoco.MjModel, data: mujoco.MjData) -> None:
    """Bring the angles of all hinges into their ranges."""
    hinges = np.flatnonzero((model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE) & (model.jnt_limited != 0))
    addresses = model.jnt_qposadr[hinges]
    data.qpos[addresses] = np.clip(data.qpos[addresses], *model.jnt_range[hinges].T)


def _lift_m(data: mujoco.MjData, is_infants: Mask, depths_m: FloatArray) -> float:
    """Return how far an infant must be lifted to be out of what it is on."""
    alone = is_infants[:, 0] != is_infants[:, 1]
    upwards = data.contact.frame[:, 2] * np.where(is_infants[:, 1], 1.0, -1.0)
    sunk = alone & (upwards > UPWARDS) & (depths_m > TOUCH_M)
    return float(((depths_m[sunk] - LEFT_M) / upwards[sunk]).max()) if sunk.any() else 0.0


def _part(
    model: mujoco.MjModel, data: mujoco.MjData, touching: IntArray, excess_m: FloatArray, yielding: FloatArray
) -> None:
    """Move all degrees of freedom, by how much each yields, so that no contact is too deep.

    Contacts that are not too deep stay as they are: neither a hand between the head and the floor nor a toy beneath a
    leg is pushed into the floor. *touching* are the contacts with penetration, *excess_m*, shape (ncon,), is by how
    much each contact is too deep, and *yielding*, shape (nv,), how much each degree of freedom gives way.
    """
    rows = np.array([_gap_rate(model, data, index) for index in touching])
    yielding, before = yielding.copy(), data.qpos.copy()
    for _ in range(AT_LIMITS):
        weighted = rows * yielding
        coupling = weighted @ rows.T
        coupling[np.diag_indices_from(coupling)] += DAMPING * coupling.diagonal().max() + np.finfo(float).tiny
        move = np.linalg.solve(coupling, excess_m[touching]) @ weighted
        move /= max(1.0, np.abs(move).max() / FARTHEST)
        data.qpos[:] = before
        mujoco.mj_integratePos(model, data.qpos, move, 1.0)
        wanted = data.qpos.copy()
        clip_angles(model, data)
        stopped = np.isin(model.jnt_qposadr, np.flatnonzero(wanted != data.qpos))
        if not stopped.any():
            return
        yielding[model.jnt_dofadr[stopped]] = 0.0


def _gap_rate(model: mujoco.MjModel, data: mujoco.MjData, index: int) -> FloatArray:
    """Return how the distance at a contact changes with each degree of freedom, shape (nv,)."""
    contact, rates = data.contact[index], np.zeros((2, 3, model.nv))
    for rate, geom in zip(rates, contact.geom, strict=True):
        mujoco.mj_jac(model, data, rate, None, contact.pos, model.geom_bodyid[geom])
    return contact.frame[:3] @ (rates[1] - rates[0])
