"""MIMo3's sensory modules, which hand out what mimoc's senses have observed."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.base.errors import MimocError
from mimoc.compat.mimo3.keywords import DEFAULT_VESTIBULAR_PARAMS
from mimoc.components.senses.touch import POINTS
from mimoc.render.picture_files import write_picture

Array = npt.NDArray[Any]
VESTIBULAR = DEFAULT_VESTIBULAR_PARAMS["sensors"]  # Order of mimoc's observation.
COMPONENTS = {"actuation": "actuation", "limits": "limits", "qpos": "angle", "qvel": "velocity", "torques": "torque"}
"""Components of proprioception in the order of MIMo3's observation, and mimoc's names for them."""


def _entry(env: Any, sense: str, keyword: str, params: Any) -> Any:
    """Return what the manifest says of a sense, or raise a MimocError, also if other parameters built it."""
    entry = getattr(env.infant.manifest.senses, sense)
    if entry is None or (params is not None and params != getattr(env, keyword)):
        raise MimocError(f"{sense} is built with the infant; give these parameters to its environment as {keyword}")
    return entry


class SimpleProprioception:
    """Joint angles, velocities, torques and limits, and the state of the actuators, in MIMo3's order: by name."""

    def __init__(self, env: Any, proprio_parameters: Mapping[str, Any] | None):
        self.env, self.proprio_parameters = env, proprio_parameters
        entry = _entry(env, "proprioception", "proprio_params", proprio_parameters)
        joints, sensors = list(entry.joints), list(entry.torque_sensors)
        sizes = dict.fromkeys(("angle", "velocity", "limits"), len(joints))
        sizes |= {"torque": 3 * len(sensors), "actuation": 2 * len(env.infant.manifest.actuation.actuators)}
        observed, start = dict[str, Any](), 0
        for part in ("angle", *entry.include):
            kept = env.actuation_model.observed if part == "actuation" else np.arange(sizes[part])
            observed[part], start = start + kept, start + sizes[part]
        self._places = {name: observed[part] for name, part in COMPONENTS.items() if part in observed}
        self.order = np.concatenate(list(self._places.values()))
        """Places in mimoc's observation of the numbers of MIMo3's."""
        self.sensor_names = {"qpos": joints, "qvel": joints, "torque": sensors, "limit": joints}

    @property
    def sensor_outputs(self) -> dict[str, Array]:
        """What was observed last, by component."""
        observed = self.env.sensed["proprioception"]
        return {name: observed[places] for name, places in self._places.items()}

    def get_proprioception_obs(self) -> Array:
        """Return all components."""
        return self.env.sensed["proprioception"][self.order]


class TrimeshTouch:
    """Forces at the skin points of bodies, which come in the order of the model."""

    def __init__(self, env: Any, touch_params: Mapping[str, Any] | None):
        entry = _entry(env, "touch", "touch_params", touch_params)
        bodies = {env.model.body(part.body).id: part for part in entry.skin}
        self.env, self._ends = env, np.cumsum([part.points for part in entry.skin])[:-1]
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
        self.env, entry = env, _entry(env, "vision", "vision_params", camera_parameters)
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
        self.env, self.vestibular_parameters = env, vestibular_parameters
        _entry(env, "vestibular", "vestibular_params", vestibular_parameters)
        self.sensors = list((vestibular_parameters or {}).get("sensors", VESTIBULAR))
        observed = [name for name in VESTIBULAR if name in self.sensors]
        self._order = np.concatenate([3 * observed.index(name) + np.arange(3) for name in self.sensors])

    @property
    def sensor_outputs(self) -> Array:
        """What was observed last."""
        return self.env.sensed["vestibular"][self._order]

    def get_vestibular_obs(self) -> Array:
        """Return what was observed."""
        return self.sensor_outputs
