"""The Gymnasium environment around a compiled infant."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import gymnasium
import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle import Bundle, read_bundle
from mimoc.errors import UnknownNameError
from mimoc.runtime.actuation import ACTUATIONS
from mimoc.runtime.model import broke_down, load_model
from mimoc.runtime.portrait import Painter
from mimoc.runtime.senses import Sense, bind_senses
from mimoc.runtime.senses.sense import FloatArray
from mimoc.schema.manifest import Manifest
from mimoc.units import to_steps

Observation = dict[str, npt.NDArray[Any]]


class InfantEnv(gymnasium.Env[Any, npt.NDArray[np.float32]]):
    """An infant in its world.

    Observation: a dictionary of one float32 array a sense; `nothing`, a zero, for an infant without senses.
    Action: one Box, a command for each actuator. The reward is zero: a bundle without a task has no goal.
    An episode ends only if the simulation becomes unstable, which `info["unstable"]` then says.
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 100}  # noqa: RUF012 - Gymnasium's own attribute.

    def __init__(
        self,
        bundle: Bundle | str | Path,
        render_mode: Literal["rgb_array"] | None = None,
        width: int = 480,
        height: int = 480,
    ):
        """Open a bundle.

        Args:
            bundle: A bundle, or the folder of one.
            render_mode: `rgb_array` for pictures from `render()`.
            width: Of the pictures, in pixels.
            height: Of the pictures, in pixels.

        Raises:
            BundleError: If the folder is not a whole bundle.
            ModelError: If MuJoCo refuses its model.
            UnknownNameError: If there is no such render mode.
        """
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise UnknownNameError("render mode", str(render_mode), self.metadata["render_modes"])
        self.bundle = bundle if isinstance(bundle, Bundle) else read_bundle(bundle)
        self.render_mode = render_mode
        self.model = load_model(self.bundle)
        self.data = mujoco.MjData(self.model)
        self._picture_size = width, height
        self._painter: Painter | None = None
        self._bind(self.manifest)

    @property
    def manifest(self) -> Manifest:
        """What the compiler says of this infant."""
        return self.bundle.manifest

    def layout(self, sense: str) -> tuple[str, ...]:
        """Return what each number of a sense is, with its unit, in the order of the observation.

        Raises:
            UnknownNameError: If this infant has no such sense.
        """
        if sense not in self._senses:
            raise UnknownNameError("sense of this infant", sense, self._senses)
        return self._senses[sense].layout

    def set_expression(self, expression: str) -> None:
        """Change what the face shows, until it is changed again.

        Raises:
            UnknownNameError: If the face cannot show it.
        """
        face = self.manifest.face
        materials = face.materials if face else {}
        if face is None or expression not in materials:
            raise UnknownNameError("face of this infant", expression, materials)
        self.model.geom(face.geom).matid = self.model.material(materials[expression]).id

    def effort(self) -> float:
        """Return what the actuators' work in the last physics step costs, for a task to take off its reward.

        The sum of u² T over n times the sum of T: of n actuators with largest torques T, each uses the share u of
        its own, which for a muscle is its activation. Servos cost nothing.
        """
        return self._act.effort(self.data)

    def keypoints(self) -> npt.NDArray[np.float64]:
        """Return the BODY_25 keypoints in the world, shape (25, 3), [m]; those of absent limbs are NaN."""
        found = np.full((len(self.manifest.keypoints), 3), np.nan)
        present = self._keypoints >= 0
        found[present] = self.data.site_xpos[self._keypoints[present]]
        return found

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict]:
        """Start again from a pose: the bundle's own, or `options={"pose": name}`.

        Raises:
            UnknownNameError: If there is no such pose or option.
        """
        super().reset(seed=seed)
        for key in set(options or {}) - {"pose"}:
            raise UnknownNameError("reset option", str(key), ["pose"])
        pose = (options or {}).get("pose", self.manifest.pose)
        if pose not in self.manifest.poses:
            raise UnknownNameError("pose", str(pose), self.manifest.poses)
        mujoco.mj_resetDataKeyframe(self.model, self.data, self.model.key(pose).id)
        mujoco.mj_forward(self.model, self.data)
        return self._observe(), {"unstable": False}

    def step(self, action: npt.NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Apply an action for one control step; what lies beyond its range is clipped.

        Raises:
            ValueError: If the action is not one number for each actuator.
        """
        self._act(action, self.data)
        mujoco.mj_step(self.model, self.data, self._steps)
        unstable = broke_down(self.data)
        observation = self._observe()
        if unstable:
            for reading in observation.values():
                np.nan_to_num(reading, copy=False)
        return observation, 0.0, unstable, False, {"unstable": unstable}

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Return a picture of the infant, shape (height, width, 3), or None without a render mode.

        Raises:
            RenderingError: If there is no OpenGL here.
        """
        if self.render_mode is None:
            return None
        if self._painter is None:
            self._painter = Painter(self.model, [self.manifest.root_body], *self._picture_size)
        return self._painter.paint(self.data)

    def close(self) -> None:
        """Free the OpenGL context, if there is one."""
        if self._painter is not None:
            self._painter.close()
            self._painter = None

    def _bind(self, manifest: Manifest) -> None:
        """Find everything the manifest names in the model, once."""
        self._steps = to_steps(manifest.step_ms, manifest.timestep_ms)
        self._act = ACTUATIONS[manifest.actuation.model](manifest.actuation, self.model)
        self._senses: Mapping[str, Sense] = bind_senses(manifest, self.model)
        site = mujoco.mjtObj.mjOBJ_SITE
        self._keypoints = np.array([mujoco.mj_name2id(self.model, site, name) for name in manifest.keypoints], int)
        self._bounds = {name: (sense.low, sense.high) for name, sense in self._senses.items()}
        self.action_space = gymnasium.spaces.Box(
            self._act.low.astype(np.float32), self._act.high.astype(np.float32), dtype=np.float32
        )
        self.observation_space = gymnasium.spaces.Dict(
            {
                name: gymnasium.spaces.Box(low.astype(np.float32), high.astype(np.float32), dtype=np.float32)
                for name, (low, high) in self._bounds.items()
            }
        )

    def _observe(self) -> Observation:
        """Return fresh arrays, clipped to their space."""
        return {name: _clipped(sense(self.data), *self._bounds[name]) for name, sense in self._senses.items()}


def _clipped(reading: FloatArray, low: FloatArray, high: FloatArray) -> npt.NDArray[np.float32]:
    """Return a reading within its bounds; unlike `np.clip`, in two calls that cost next to nothing."""
    np.maximum(reading, low, out=reading)
    np.minimum(reading, high, out=reading)
    return reading.astype(np.float32)


def make(bundle: Bundle | str | Path, **options: Any) -> gymnasium.Env:
    """Return the environment of a bundle, as `gymnasium.make("mimoc/Infant-v0", bundle=..., **options)` does."""
    return gymnasium.make("mimoc/Infant-v0", bundle=bundle, **options)
