"""Conversion of desired joint torques to an action, by actuation model."""

from collections.abc import Callable, Mapping
from typing import Protocol

import mujoco

from mimoc.actuation.binding import Actuation
from mimoc.control.antagonists import Antagonists
from mimoc.control.motors import Motors
from mimoc.errors import ControlError
from mimoc.senses.sense import FloatArray, IntArray


class TorqueMapping(Protocol):
    """Converts torques of n joints to an action."""

    @property
    def strength_nm(self) -> FloatArray:
        """Largest torque of each joint, shape (n,)."""
        ...

    def rest(self, model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
        """Set the joints' actuators to rest and update `data.qfrc_actuator`.

        Returns:
            Smallest and largest torque that they could add in this state, shape (n, 2), [N m].
        """
        ...

    def command(self, torques_nm: FloatArray) -> FloatArray:
        """Return the action, shape (nu,), that adds torques, shape (n,), to those at rest."""
        ...


TORQUE_MAPPINGS: Mapping[str, Callable[[Actuation, IntArray, mujoco.MjModel, float], TorqueMapping]] = {
    "torque": Motors,
    "muscle": Antagonists,
}
"""Torque mapping by actuation model. Servos have none, because their commands are angles and not torques."""


def map_torques(
    model_name: str, actuation: Actuation, joints: IntArray, model: mujoco.MjModel, step_s: float
) -> TorqueMapping:
    """Return the torque mapping of an actuation model.

    Args:
        model_name: The actuation model.
        actuation: Conversion of actions to controls.
        joints: Index of each joint, shape (n,).
        model: The infant and its world.
        step_s: Duration of a control step.

    Raises:
        ControlError: If the actuation model cannot produce given torques.
    """
    if model_name not in TORQUE_MAPPINGS:
        others = " or ".join(f"{{model: {other}}}" for other in TORQUE_MAPPINGS)
        raise ControlError(
            f"inverse dynamics computes torques, which the actuation model '{model_name}' does not accept; build the "
            f"infant with actuation: {others}"
        )
    return TORQUE_MAPPINGS[model_name](actuation, joints, model, step_s)
