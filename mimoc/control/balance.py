"""Balance: objectives that stabilise legs and trunk while the arms move."""

import mujoco
import numpy as np

from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import in_subtrees
from mimoc.control.gains import Gains
from mimoc.control.limbs import trunk_of
from mimoc.control.objectives import Align
from mimoc.control.posture import Posture
from mimoc.senses.sense import IntArray

BALANCING = Gains(100.0, viscosity_per_s=20.0)
"""Gains for the chest, which keeps its orientation while the arms move."""
LYING = 0.5
"""Cosine of 60°, the tilt of the chest beyond which an infant counts as lying."""


class Balance:
    """Determines whether an infant lies, sits or stands, and the objectives that keep it stable."""

    def __init__(self, model: mujoco.MjModel, manifest: Manifest):
        """Find trunk and legs of an infant."""
        self._model, self._manifest = model, manifest
        self._trunk = trunk_of(manifest.anatomy, model)
        actuators = [actuator for actuator in manifest.actuation.actuators if actuator.commanded]
        self._moved = list(dict.fromkeys(model.joint(actuator.joint).id for actuator in actuators))

    def lies(self, data: mujoco.MjData) -> bool:
        """Return whether the chest is tilted so far that the infant lies."""
        return bool(data.xmat[self._trunk[-1]].reshape(3, 3)[2, 2] < LYING)

    def sits_freely(self, data: mujoco.MjData) -> bool:
        """Return whether the infant is upright and supported only by the ground."""
        return not self._manifest.constraints.welds and not self.lies(data)

    def objectives(self, data: mujoco.MjData) -> list[Posture | Align]:
        """Return the objectives that keep the infant stable: first the posture of its legs, then an upright chest.

        For an infant that lies, these are only the postures of legs and spine, since the ground supports its chest.
        """
        model = self._model
        roots = [model.body(leg.root).id for leg in self._manifest.anatomy.legs]
        legs = self._joints_on(np.flatnonzero(in_subtrees(model, roots)))
        if self.lies(data):
            return [Posture(joints=[*legs, *self._joints_on(np.array(self._trunk, np.intp))])]
        chest = data.body(self._trunk[-1])
        return [Posture(joints=legs), Align(chest.name, chest.xmat.reshape(3, 3), gains=BALANCING)]

    def loose_feet(self, data: mujoco.MjData) -> list[str]:
        """Return the feet of a sitting infant, which may slide; counted as sticking, they creep until legs cross.

        The feet of a standing infant, whose hip is high above them, stick.
        """
        feet = [leg.end for leg in self._manifest.anatomy.legs if leg.end]
        root_m = data.body(self._manifest.root_body).xpos
        away_m = [root_m - data.body(foot).xpos for foot in feet]
        return [foot for foot, way in zip(feet, away_m, strict=True) if way[2] < 0.5 * np.linalg.norm(way)]

    def _joints_on(self, bodies: IntArray) -> list[str]:
        """Return the commanded joints of some bodies."""
        chosen = np.isin(self._model.jnt_bodyid[self._moved], bodies)
        return [self._model.joint(joint).name for joint, is_on in zip(self._moved, chosen, strict=True) if is_on]
