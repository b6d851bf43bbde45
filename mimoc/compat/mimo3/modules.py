"""MIMo3's sensory and actuation modules, which hand out what mimoc has sensed and take commands as MIMo3's do."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box

from mimoc.base.errors import MimocError
from mimoc.compat.mimo3.keywords import DEFAULT_VESTIBULAR_PARAMS
from mimoc.components.senses.touch import POINTS
from mimoc.render.picture_files import write_picture

Array = npt.NDArray[Any]
FloatArray = npt.NDArray[np.float64]
VESTIBULAR = DEFAULT_VESTIBULAR_PARAMS["sensors"]  # The sensors in the order of mimoc's observation.
COMPONENTS = {"actuation": "actuation", "limits": "limits", "qpos": "angle", "qvel": "velocity", "torques": "torque"}
"""Components of proprioception in the order of MIMo3's observation, and mimoc's names for them."""


def _entry(env: Any, sense: str, keyword: str, params: Any) -> Any:
    """Return what the manifest says of a sense; raise a MimocError if it is missing or other parameters built it."""
    entry = getattr(env.infant.manifest.senses, sense)
    if entry is None or (params is not None and params != getattr(env, keyword)):
        raise MimocError(f"{sense} is built with the infant; give these parameters to its environment as {keyword}")
    return entry


class SimpleProprioception:
    """Joint angles, velocities, torques and limits, and the state of the actuators, as components in MIMo3's order."""

    def __init__(self, env: Any, proprio_parameters: Mapping[str, Any] | None):
        self.env = env
        self.proprio_parameters = proprio_parameters
        entry = _entry(env, "proprioception", "proprio_params", proprio_parameters)
        joints = list(entry.joints)
        sensors = list(entry.torque_sensors)
        sizes = dict.fromkeys(("angle", "velocity", "limits"), len(joints))
        sizes |= {"torque": 3 * len(sensors), "actuation": 2 * len(env.infant.manifest.actuation.actuators)}
        places = dict[str, Any]()  # Where each of mimoc's components stands in mimoc's observation.
        start = 0
        for component in ("angle", *entry.include):
            kept = env.actuation_model.observed if component == "actuation" else np.arange(sizes[component])
            places[component] = start + kept
            start += sizes[component]
        self._places = {name: places[component] for name, component in COMPONENTS.items() if component in places}
        self.order = np.concatenate(list(self._places.values()))
        """Index in mimoc's observation of each number of MIMo3's."""
        self.sensor_names = {"qpos": joints, "qvel": joints, "torque": sensors, "limit": joints}

    @property
    def sensor_outputs(self) -> dict[str, Array]:
        """What was observed last, by component."""
        numbers = self.env.sensed["proprioception"]
        return {name: numbers[places] for name, places in self._places.items()}

    def get_proprioception_obs(self) -> Array:
        """Return all components."""
        return self.env.sensed["proprioception"][self.order]


class TrimeshTouch:
    """Forces at the skin points of bodies, which come in the order of the model."""

    def __init__(self, env: Any, touch_params: Mapping[str, Any] | None):
        entry = _entry(env, "touch", "touch_params", touch_params)
        bodies = {env.model.body(part.body).id: part for part in entry.skin}
        self.env = env
        self._ends = np.cumsum([part.points for part in entry.skin])[:-1]
        points_m = env.infant.bundle.arrays[POINTS]
        self.touch_size = 1 if entry.quantity == "normal" else 3
        self.sensor_scales = {body: part.spacing_m for body, part in bodies.items()}
        self.sensor_positions = dict(zip(bodies, np.split(points_m, self._ends), strict=True))

    @property
    def sensor_outputs(self) -> dict[int, Array]:
        """What was observed last, by index of the body, shape (points, numbers)."""
        points = self.env.sensed["touch"].reshape(-1, self.touch_size)
        return dict(zip(self.sensor_positions, np.split(points, self._ends), strict=True))

    def get_sensor_count(self, body_id: int) -> int:
        """Return the number of points of a body."""
        return len(self.sensor_positions[body_id])

    def get_total_sensor_count(self) -> int:
        """Return the number of all points."""
        return sum(map(len, self.sensor_positions.values()))

    def get_touch_obs(self) -> Array:
        """Return the numbers of all points, shape (points, numbers)."""
        return self.env.sensed["touch"].reshape(-1, self.touch_size)


class SimpleVision:
    """Pictures of the eyes."""

    def __init__(self, env: Any, camera_parameters: Mapping[str, Any] | None):
        self.env = env
        entry = _entry(env, "vision", "vision_params", camera_parameters)
        self.camera_parameters = camera_parameters or dict.fromkeys(entry.cameras)

    @property
    def sensor_outputs(self) -> dict[str, Array]:
        """The pictures that were observed last, by camera."""
        return {name: self.env.sensed[name] for name in self.camera_parameters}

    def get_vision_obs(self) -> dict[str, Array]:
        """Return the pictures."""
        return self.sensor_outputs

    def save_obs_to_file(self, directory: str | Path, suffix: str = "") -> None:
        """Write the pictures that were observed last as PNGs into a folder, which is made if it is missing."""
        folder = Path(directory)
        folder.mkdir(parents=True, exist_ok=True)
        for name, picture in self.sensor_outputs.items():
            write_picture(folder / f"{name}{suffix}.png", picture)


class SimpleVestibular:
    """Specific force and angular velocity of the head."""

    def __init__(self, env: Any, vestibular_parameters: Mapping[str, Any] | None):
        self.env = env
        self.vestibular_parameters = vestibular_parameters
        _entry(env, "vestibular", "vestibular_params", vestibular_parameters)
        self.sensors = list((vestibular_parameters or {}).get("sensors", VESTIBULAR))
        kept = [name for name in VESTIBULAR if name in self.sensors]
        self._order = np.concatenate([3 * kept.index(name) + np.arange(3) for name in self.sensors])

    @property
    def sensor_outputs(self) -> Array:
        """What was observed last."""
        return self.env.sensed["vestibular"][self._order]

    def get_vestibular_obs(self) -> Array:
        """Return what was observed."""
        return self.sensor_outputs


class ActuationModel:
    """What actions mean; `env.actuation_model` is one that is bound to an environment."""

    model = ""  # mimoc's name of the model.
    order: npt.NDArray[np.intp]  # Index in mimoc's action of each number of MIMo3's action, shape (n,).
    observed: npt.NDArray[np.intp]
    """Index in mimoc's `actuation` component of proprioception of each number of MIMo3's."""

    def __init__(self, env: Any, actuators: Any = None):
        """Find the actuators of an environment; those of a subclass of the user's cannot be taken over."""
        self.env = env
        self._act = env.infant.actuation
        self.actuators = self._act.actuators
        entries = env.infant.manifest.actuation.actuators
        commanded = [entry.name for entry in entries if entry.commanded]
        self.order = _by_direction(commanded)
        everything = _by_direction([entry.name for entry in entries])
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
        # `super().__init__` calls `get_action_space`, which needs these ranges.
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
