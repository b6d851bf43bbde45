"""What programs use of MIMo3's access to models: joints and their locks, geoms, places."""

from typing import Any

import mujoco
import numpy as np
import numpy.typing as npt

SIZES = {mujoco.mjtJoint.mjJNT_FREE: (7, 6), mujoco.mjtJoint.mjJNT_BALL: (4, 3)}
"""Number of entries of one joint in qpos and qvel, by the type of the joint; all other types have one each."""


def get_joint_qpos_addr(model: mujoco.MjModel, joint_id: int) -> range:
    """Return where the position of a joint stands in qpos."""
    start = int(model.jnt_qposadr[joint_id])
    return range(start, start + SIZES.get(mujoco.mjtJoint(model.jnt_type[joint_id]), (1, 1))[0])


def get_joint_qvel_addr(model: mujoco.MjModel, joint_id: int) -> range:
    """Return where the velocity of a joint stands in qvel."""
    start = int(model.jnt_dofadr[joint_id])
    return range(start, start + SIZES.get(mujoco.mjtJoint(model.jnt_type[joint_id]), (1, 1))[1])


def set_joint_qpos(model: mujoco.MjModel, data: mujoco.MjData, joint_name: str, qpos: Any) -> None:
    """Set the position of a joint, in [rad] or [m]."""
    data.joint(joint_name).qpos[:] = qpos


def set_joint_locking_angle(model: mujoco.MjModel, joint_name: str, angle: float) -> None:
    """Set the angle that a joint is locked at, in [rad] from where the model has it."""
    model.equality(joint_name).data[:] = 0
    model.equality(joint_name).data[0] = angle


def lock_joint(model: mujoco.MjModel, joint_name: str, joint_angle: float | None = None) -> None:
    """Lock a joint from the next reset on."""
    if joint_angle is not None:
        set_joint_locking_angle(model, joint_name, joint_angle)
    model.eq_active0[model.equality(joint_name).id] = True


def unlock_joint(model: mujoco.MjModel, joint_name: str) -> None:
    """Unlock a joint from the next reset on."""
    model.eq_active0[model.equality(joint_name).id] = False


def get_geoms_for_body(model: mujoco.MjModel, body_id: int) -> range:
    """Return the indices of a body's geoms."""
    start = int(model.body_geomadr[body_id])
    return range(start, start + int(model.body_geomnum[body_id]))


def get_body_position(data: mujoco.MjData, body_id: int) -> npt.NDArray[np.float64]:
    """Return where a body is in the world, shape (3,), [m]."""
    return data.xpos[body_id]


def __getattr__(name: str) -> Any:
    raise AttributeError(f"mimo_utils has no '{name}' here; use MuJoCo's names, such as data.body('head').xpos")
