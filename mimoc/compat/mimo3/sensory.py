"""MIMo3's sensory modules, which hand out what mimoc's senses have observed."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from mimoc.compat.mimo3.defaults import DEFAULT_VESTIBULAR_PARAMS
from mimoc.render.picture_files import write_picture
from mimoc.senses.touch import POINTS

Array = npt.NDArray[Any]
VESTIBULAR = DEFAULT_VESTIBULAR_PARAMS["sensors"]
"""Order of mimoc's observation."""


class SimpleProprioception:
    """Joint angles, velocities, torques and limits, and the state of the actuators, in MIMo3's order: by name."""

    def __init__(self, env: Any, proprio_parameters: Mapping[str, Any] | None):
        """Find where each component stands in mimoc's observation."""
        self.env, self.proprio_parameters = env, proprio_parameters
        entry = env.infant.manifest.senses.proprioception
        joints, sensors = list(entry.joints), list(entry.torque_sensors)
        actuation = env.actuation_model.observed
        parts = {"angle": len(joints), "velocity": len(joints), "limits": len(joints)}
        parts |= {"torque": 3 * len(sensors), "actuation": actuation.size}
        starts = np.cumsum([0, *(parts[name] for name in ("angle", *entry.include))])
        place = dict(zip(("angle", *entry.include), starts, strict=False))
        wanted = {
            "actuation": "actuation",
            "limits": "limits",
            "qpos": "angle",
            "qvel": "velocity",
            "torques": "torque",
        }
        self._places = {
            name: place[part] + (actuation if part == "actuation" else np.arange(parts[part]))
            for name, part in wanted.items()
            if part in place
        }
        self.order = np.concatenate(list(self._places.values()))
        """Places in mimoc's observation of the numbers of MIMo3's."""
        self.output_components = list(entry.include)
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
        """Find the points of each body."""
        entry = env.infant.manifest.senses.touch
        bodies = {env.model.body(part.body).id: part for part in entry.skin}
        self.env, self._ends = env, np.cumsum([part.points for part in entry.skin])[:-1]
        points_m = env.infant.bundle.arrays[POINTS]
        self.touch_type, self.response_type = entry.quantity, entry.response
        self.touch_size = 1 if entry.quantity == "normal" else 3
        self.sensor_scales = {body: part.spacing_m for body, part in bodies.items()}
        self.sensor_positions = dict(zip(bodies, np.split(points_m, self._ends), strict=True))

    @property
    def sensor_outputs(self) -> dict[int, Array]:
        """What was observed last, by index of the body, shape (points, numbers)."""
        points = self.env.sensed["touch"].reshape(-1, self.touch_size)
        return dict(zip(self.sensor_positions, np.split(points, self._ends), strict=True))

    @property
    def sensing_bodies(self) -> list[int]:
        """Indices of the bodies that have points."""
        return list(self.sensor_positions)

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
        """See with the eyes that the parameters name, or with both."""
        self.env = env
        self.camera_parameters = camera_parameters or dict.fromkeys(env.infant.manifest.senses.vision.cameras)

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
        """Hand out what was observed, in the order of the parameters."""
        self.env, self.vestibular_parameters = env, vestibular_parameters
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
