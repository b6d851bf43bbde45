"""Supports: the constraints that hold an infant, such as contacts with the ground that it sits on."""

from collections.abc import Iterable

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.control.frames import limb_of, trunk_of
from mimoc.senses.sense import FloatArray, IntArray

_EQUALITY = int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
_TENDON_END = int(mujoco.mjtConstraint.mjCNSTR_LIMIT_TENDON)
_FIRST_CONTACT = int(mujoco.mjtConstraint.mjCNSTR_CONTACT_FRICTIONLESS)
"""First of MuJoCo's constraint types that are contacts."""
MOST_PLAY_RAD = 0.05
"""Range below which a tendon couples its joints, as in the spine (0.02 rad); with a wider one, it only limits them."""
_STICKING = int(mujoco.mjtConstraintState.mjCNSTRSTATE_QUADRATIC)


class Supports:
    """Finds the rows of MuJoCo's constraints that hold the infant.

    These are all welds and locks, the couplings of the joints of the spine, limits of other tendons, such as those of
    the neck, and sticking contacts with static geoms; of the contacts of loose bodies only the normals. Contacts of
    limbs that objectives control are excluded, because they would prevent the demanded motion; so are dry friction,
    which yields, and joint limits, which are one-sided.
    """

    def __init__(self, model: mujoco.MjModel, manifest: Manifest, effectors: Iterable[int], loose: Iterable[int] = ()):
        """Find the bodies that can support the infant.

        Args:
            model: The infant and its world.
            manifest: Manifest of the infant, which names its trunk and its limbs.
            effectors: The bodies that objectives control.
            loose: Bodies that, with their descendants, may slide on the ground that they touch.
        """
        self._model, self._couplings = model, _couplings(model)
        bearing = model.body_rootid == model.body(manifest.root_body).id
        trunk = trunk_of(manifest.anatomy, model)
        busy = {limb_of(effector, trunk, model) for effector in effectors} - {0}
        bearing &= ~in_subtrees(model, list(busy))
        sliding = in_subtrees(model, list(loose))
        still = model.body_weldid == 0
        # The last entries are for constraints without geoms.
        self._bearing = np.append((bearing & ~sliding)[model.geom_bodyid], False)
        self._sliding = np.append((bearing & sliding)[model.geom_bodyid], False)
        self._still = np.append(still[model.geom_bodyid], False)

    def rows(self, data: mujoco.MjData) -> IntArray:
        """Return the constraints that hold the infant, shape (m,); *data* must have the solver's forces."""
        kinds = data.efc_type
        holding = kinds == _EQUALITY
        holding |= (kinds == _TENDON_END) & (data.efc_state == _STICKING)
        contacts = np.flatnonzero((kinds >= _FIRST_CONTACT) & (data.efc_state == _STICKING))
        if len(contacts):
            geoms = data.contact.geom[data.efc_id[contacts]]
            holding[contacts] = self._on_static(self._bearing, geoms)
        holding[self._normals(data)] = True
        return np.flatnonzero(holding)

    def jacobian(self, data: mujoco.MjData) -> FloatArray:
        """Return the Jacobian of the constraints that hold the infant, shape (m, nv)."""
        rows = self.rows(data)
        if not mujoco.mj_isSparse(self._model):
            held = data.efc_J.reshape(data.nefc, self._model.nv)[rows]
            return np.concatenate([self._couplings, held])
        count = len(self._couplings)
        dense = np.zeros((count + len(rows), self._model.nv))
        dense[:count] = self._couplings
        if len(rows):
            lengths, starts = data.efc_J_rownnz[rows], data.efc_J_rowadr[rows]
            mujoco.mju_sparse2dense(dense[count:], data.efc_J, lengths, starts, data.efc_J_colind)
        return dense

    def _normals(self, data: mujoco.MjData) -> IntArray:
        """Return the constraints with which loose bodies press on static geoms, shape (k,).

        With the elliptic friction cones of bundles the first constraint of a contact is its normal.
        """
        first = data.contact.efc_address
        pressing = (first >= 0) & self._on_static(self._sliding, data.contact.geom)
        pressing[pressing] = data.efc_force[first[pressing]] > 0.0
        return first[pressing]

    def _on_static(self, ours: npt.NDArray[np.bool_], geoms: IntArray) -> npt.NDArray[np.bool_]:
        """Return which contacts of geoms, shape (m, 2), are between one of ours and a static one, shape (m,)."""
        return np.logical_or.reduce(ours[geoms] & self._still[geoms[:, ::-1]], axis=1)


def _couplings(model: mujoco.MjModel) -> FloatArray:
    """Return the Jacobian of the tendons that couple joints, shape (m, nv)."""
    play_rad = np.diff(model.tendon_range, axis=1)[:, 0]
    tendons = np.flatnonzero((model.tendon_limited != 0) & (play_rad < MOST_PLAY_RAD))
    couplings = np.zeros((len(tendons), model.nv))
    for row, tendon in zip(couplings, tendons, strict=True):
        first = model.tendon_adr[tendon]
        wraps = np.arange(first, first + model.tendon_num[tendon])
        row[model.jnt_dofadr[model.wrap_objid[wraps]]] = model.wrap_prm[wraps]
    return couplings
