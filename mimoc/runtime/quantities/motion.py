"""What is measured after a control step: terms of motion of k infants at once, and contacts, which no term counts."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from mimoc.bundle.manifest import Manifest
from mimoc.runtime.infant import Infant
from mimoc.runtime.term import Term
from mimoc.runtime.worlds import Worlds


@dataclass(frozen=True)
class JointSpeed(Term):
    """Mean absolute velocity of the hinges, mean over j of |qvel_j|, shape (k,), [rad/s]."""

    dofs: np.ndarray  # Degree of freedom of each hinge, shape (hinges,).

    def __call__(self, worlds: Worlds, *args: Any) -> Any:
        """Return it for k infants."""
        xp = worlds.xp
        return xp.mean(xp.abs(xp.take(worlds.qvel, self.dofs, axis=1)), axis=1)


@dataclass(frozen=True)
class BodyPosition(Term):
    """Position of the frame of a body in the world, shape (k, 3), [m]."""

    body: int

    def __call__(self, worlds: Worlds, *args: Any) -> Any:
        """Return it for k infants."""
        return worlds.xpos[:, self.body, :]


@dataclass(frozen=True)
class BodyHeight(Term):
    """Height of the centre of mass of a body above z = 0, shape (k,), [m]."""

    body: int

    def __call__(self, worlds: Worlds, *args: Any) -> Any:
        """Return it for k infants."""
        return worlds.xipos[:, self.body, 2]


def joint_speed_rad_s(model: mujoco.MjModel, manifest: Manifest) -> Term:
    """Return the term of the speed of all hinges of the infant."""
    is_of_infant = model.body_rootid[model.jnt_bodyid] == model.body(manifest.root_body).id
    return JointSpeed(model.jnt_dofadr[is_of_infant & (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE)])


def hip_path_m(model: mujoco.MjModel, manifest: Manifest) -> Term:
    """Return the term of the place of the infant's root body, the hip."""
    return BodyPosition(model.body(manifest.root_body).id)


def head_height_m(model: mujoco.MjModel, manifest: Manifest) -> Term:
    """Return the term of the height of the head, or of the root body of an infant without one."""
    return BodyHeight(model.body(manifest.anatomy.head or manifest.root_body).id)


head_lowest_m = head_height_m


def contacts_self(env: Infant) -> Callable[[], float]:
    """Return a function that counts the contacts of this moment between parts of the infant's own body."""

    def count() -> float:
        model = env.model
        is_own = model.body_rootid[model.geom_bodyid] == model.body(env.manifest.root_body).rootid
        pairs = env.data.contact.geom.reshape(-1, 2)
        return int(np.count_nonzero((pairs >= 0).all(axis=1) & is_own[pairs].all(axis=1)))

    return count
