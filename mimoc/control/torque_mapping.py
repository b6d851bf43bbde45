"""From the torques that joints are to have to an action, by actuation model."""

from collections.abc import Callable, Mapping
from typing import Protocol

import mujoco

from mimoc.actuation.binding import Actuation
from mimoc.control.antagonists import Antagonists
from mimoc.control.motors import Motors
from mimoc.errors import ControlError
from mimoc.senses.sense import FloatArray, IntArray


class TorqueMapping(Protocol):
    """Turns the torques of n joints into an action."""

    @property
    def strength_nm(self) -> FloatArray:
        """Largest torque of each joint, shape (n,)."""
        ...

    def rest(self, model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
        """Let the joints' actuators rest and compute `data.qfrc_actuator`.

        Returns:
            Least and largest torque that they could add to that now, shape (n, 2), [N m].
        """
        ...

    def command(self, torques_nm: FloatArray) -> FloatArray:
        """Return the action, shape (nu,), that adds some torques, shape (n,)."""
        ...


TORQUE_MAPPINGS: Mapping[str, Callable[[Actuation, IntArray, mujoco.MjModel, float], TorqueMapping]] = {
    "torque": Motors,
    "muscle": Antagonists,
}
"""By actuation model. Servos have none: they take angles, and no command says how strong they are to be."""


def map_torques(
    model_name: str, actuation: Actuation, joints: IntArray, model: mujoco.MjModel, step_s: float
) -> TorqueMapping:
    """Return what turns torques into actions.

    Args:
        model_name: The actuation model.
        actuation: What turns an action into controls.
        joints: Index of each joint, shape (n,).
        model: The infant and its world.
        step_s: A control step.

    Raises:
        ControlError: If the actuation model takes no torques.
    """
    if model_name not in TORQUE_MAPPINGS:
        others = " or ".join(f"{{model: {other}}}" for other in TORQUE_MAPPINGS)
        raise ControlError(
            f"inverse dynamics computes torques, which the actuation model '{model_name}' does not take; build the "
            f"infant with actuation: {others}"
        )
    return TORQUE_MAPPINGS[model_name](actuation, joints, model, step_s)
