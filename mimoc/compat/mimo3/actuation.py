"""MIMo3's actuation models, by name: which of mimoc's they are, and how their actions are mimoc's."""

from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box

from mimoc.base.errors import MimocError

FloatArray = npt.NDArray[np.float64]


class ActuationModel:
    """What actions mean; `env.actuation_model` is one that is bound to an environment."""

    model = ""  # mimoc's name.
    order: npt.NDArray[np.intp]  # Places in mimoc's action of the numbers of MIMo3's, shape (n,).
    observed: npt.NDArray[np.intp]
    """Places of the numbers of MIMo3's actuation among those that mimoc's proprioception has of it."""

    def __init__(self, env: Any, actuators: Any = None):
        """Find the actuators of an environment; those of a subclass of the user's cannot be taken over."""
        self.env, self._act = env, env.infant.actuation
        self.actuators = self._act.actuators
        entries = env.infant.manifest.actuation.actuators
        commanded = [entry.name for entry in entries if entry.commanded]
        self.order, everything = _by_direction(commanded), _by_direction([entry.name for entry in entries])
        self.observed = np.concatenate([everything, len(entries) + everything])
        self.action_space = self.get_action_space()
        self.control_input = np.zeros(self.action_space.shape)

    @property
    def n_actuators(self) -> int:
        """Number of commanded actuators of the model."""
        return len(self.actuators)

    def get_action_space(self) -> Box:
        """Return the space of actions."""
        low, high = self._act.low[self.order], self._act.high[self.order]
        return Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)

    def command(self, action: npt.ArrayLike) -> FloatArray:
        """Return mimoc's action for one of MIMo3's, and keep it as `control_input`."""
        numbers = np.asarray(action, np.float64)
        if numbers.shape != self.action_space.shape:
            raise ValueError(f"expected an action of shape {self.action_space.shape}, got shape {numbers.shape}")
        self.control_input = np.clip(numbers, self.action_space.low, self.action_space.high)
        commands = np.empty(len(self.order))
        commands[self.order] = self.control_input
        return commands

    def action(self, action: npt.ArrayLike) -> None:
        """Set the controls of the model, without delay."""
        data = self.env.data
        data.ctrl[self.actuators] = self._act.controls(self.command(action), data)

    def observations(self) -> npt.NDArray[Any]:
        """Return what proprioception has of the actuators; raise a MimocError if it does not include them."""
        outputs = self.env.proprioception.sensor_outputs
        if "actuation" not in outputs:
            raise MimocError("the actuation is not observed; add 'actuation' to the components of proprio_params")
        return outputs["actuation"]

    def simulation_torque(self) -> FloatArray:
        """Return the torque of each actuator about its joint, [N m]."""
        return self.env.model.actuator_gear[self.actuators, 0] * self.env.data.actuator_force[self.actuators]

    def cost(self) -> float:
        """Return the effort of the last physics step, by MIMo's formula."""
        return self.env.infant.effort()

    def reset(self) -> None:
        """Command nothing."""
        self.action(np.zeros(self.action_space.shape))


class SpringDamperModel(ActuationModel):
    """Motors that give the commanded share of their largest torque: mimoc's `torque`."""

    model = "torque"


class MuscleModel(ActuationModel):
    """Two muscles a joint, first all that pull it to negative angles: mimoc's `muscle`, which are MuJoCo's muscles."""

    model = "muscle"


class PositionalModel(ActuationModel):
    """Servos that are commanded by angles in [rad]: mimoc's `position`."""

    model = "position"

    def __init__(self, env: Any, actuators: Any = None):
        self._range = env.model.jnt_range[env.model.actuator_trnid[env.infant.actuation.actuators, 0]]
        super().__init__(env, actuators)
        self.observed = self.observed[: len(self.observed) // 2]

    def get_action_space(self) -> Box:
        """Return the ranges of the joints."""
        low, high = self._range.T.astype(np.float32)
        return Box(low, high, dtype=np.float32)

    def command(self, action: npt.ArrayLike) -> FloatArray:
        """Return each angle as its place in the joint's range, from -1 to 1."""
        low, high = self._range.T
        return 2 * (super().command(action) - low) / (high - low) - 1


MODELS = {kind.__name__: kind for kind in (SpringDamperModel, MuscleModel, PositionalModel)}


def model_named(actuation_model: Any) -> type[ActuationModel] | None:
    """Return the model that a class, such as MIMo3's, or a name stands for, None for None, or raise a MimocError."""
    if actuation_model is None:
        return None
    name = actuation_model if isinstance(actuation_model, str) else getattr(actuation_model, "__name__", "")
    if name not in MODELS:
        raise MimocError(
            f"actuation_model {name or actuation_model!r} has no counterpart; give {', '.join(MODELS)}, or write your "
            "own as docs/own_actuation.md shows and name it in a spec"
        )
    return MODELS[name]


def model_of(name: str) -> type[ActuationModel]:
    """Return the model for one of mimoc's, which a spec names; one of a plug-in keeps its own actions."""
    return next((kind for kind in MODELS.values() if kind.model == name), ActuationModel)


def _by_direction(names: list[str]) -> npt.NDArray[np.intp]:
    """Return the order of actuators in which muscles towards negative angles come first, and motors as they are."""
    return np.argsort([name.endswith("_positive") for name in names], kind="stable")
