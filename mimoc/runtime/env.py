"""The Gymnasium environment around a compiled infant."""

import copy
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal

import gymnasium
import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.actuation.binding import Actuation, bind_actuation
from mimoc.bundle.io import Bundle, read_bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import broke_down, load_model
from mimoc.bundle.poses import pose_of
from mimoc.delays.schedule import Schedule
from mimoc.delays.timing import Timing
from mimoc.errors import UnknownNameError
from mimoc.model_fields import ModelFields
from mimoc.noise.streams import NoiseStreams
from mimoc.render.environment import MODES, EnvRenderer, available_modes
from mimoc.runtime.constraints import Constraints
from mimoc.senses.binding import bind_senses
from mimoc.senses.custom import CustomSense
from mimoc.senses.sense import Observation, Sense
from mimoc.tasks.binding import bind_task
from mimoc.tasks.custom import CustomTask
from mimoc.tasks.task import NO_REWARD, Task
from mimoc.units import ms_to_s

if TYPE_CHECKING:  # It needs SciPy, which most environments do without.
    from mimoc.senses.touch.run import SkinState

STATE = mujoco.mjtState.mjSTATE_INTEGRATION
"""The complete state of MuJoCo's integration."""


class InfantEnv(gymnasium.Env[Any, npt.NDArray[np.float32]]):
    """An infant in its scene.

    Observation: a dictionary with one float32 array for each of proprioception, vestibular sense and touch, and one
    uint8 image, shape (H, W, 3), for each eye; an infant without senses observes `nothing`, a single zero.
    Action: a Box with one command for each commanded actuator.
    Reward and termination are those of the bundle's task, and episodes are truncated after the task's number of steps;
    without a task the reward is zero and episodes do not end. An episode also terminates if the simulation becomes
    unstable. `info` contains `is_success`, the terms of the reward as `reward_terms`, and `unstable`.
    """

    metadata = {"render_modes": [*MODES], "render_fps": 100}  # noqa: RUF012 - Gymnasium's own attribute.

    def __init__(
        self,
        bundle: Bundle | str | Path,
        render_mode: Literal["human", "rgb_array"] | None = None,
        width: int = 480,
        height: int = 480,
        next_bundle: Callable[[int], Bundle] | None = None,
        task: Any = None,
        senses: Mapping[str, Any] = MappingProxyType({}),
    ):
        """Open a bundle.

        Args:
            bundle: A bundle, or a bundle folder.
            render_mode: `human` for a window that is updated at every step, `rgb_array` for images from `render()`.
            width: Width of the images, in pixels.
            height: Height of the images, in pixels.
            next_bundle: Function that returns the same infant in the scene of another seed, for `reset`.
            task: Object that replaces the bundle's task; see `tasks.custom.CustomTask`.
            senses: Objects that are added to the bundle's senses, by name; see `senses.custom.CustomSense`.

        Raises:
            BundleError: If the folder is not an intact bundle.
            ModelError: If MuJoCo rejects its model.
            RenderingError: If vision or the render mode needs OpenGL or a display that is not available.
            UnknownNameError: If there is no such render mode.
            KindError: If an added sense has the name of an existing one.
        """
        if render_mode not in (None, *MODES):
            raise UnknownNameError("render mode", str(render_mode), MODES)
        self.bundle = bundle if isinstance(bundle, Bundle) else read_bundle(bundle)
        self.render_mode = render_mode
        self.metadata = {
            "render_modes": available_modes(),
            "render_fps": round(1 / ms_to_s(self.manifest.step_ms)),
        }
        self.model = load_model(self.bundle)
        self._picture_size = width, height
        self._next_bundle = next_bundle
        self._custom_task, self._custom_senses = task, dict(senses)
        self._noise = NoiseStreams(self.np_random_seed)
        self._bind()

    @property
    def manifest(self) -> Manifest:
        """Everything the compiler tells the runtime about this infant."""
        return self.bundle.manifest

    @property
    def actuation(self) -> Actuation:
        """The mapping from actions to controls: actuators in the order of the action, and their limits."""
        return self._act

    @property
    def senses(self) -> Mapping[str, Sense]:
        """What it senses with, by name."""
        return self._senses

    @property
    def task(self) -> Task:
        """What starts its episodes and judges its steps."""
        return self._task

    @property
    def schedule(self) -> Schedule:
        """Its control step, with all signals on their way."""
        return self._schedule

    @property
    def steps(self) -> int:
        """Control steps of this episode so far."""
        return self._steps

    @property
    def max_steps(self) -> int | None:
        """Control steps after which an episode is truncated; None is never."""
        return self._task.steps

    def layout(self, sense: str) -> tuple[str, ...]:
        """Return the name and unit of each element of a sense's observation, in order.

        Raises:
            UnknownNameError: If this infant has no such sense.
        """
        return self._sense(sense).layout

    @property
    def skin(self) -> "SkinState":
        """The current positions, bodies and forces of all skin points, without delay.

        Raises:
            UnknownNameError: If this infant has no sense of touch.
        """
        touch: Any = self._sense("touch")
        return touch.skin_state(self.data)

    def set_expression(self, expression: str) -> None:
        """Change the facial expression.

        Raises:
            UnknownNameError: If there is no such expression.
        """
        face = self.manifest.face
        materials = face.materials if face else {}
        if face is None or expression not in materials:
            raise UnknownNameError("facial expression of this infant", expression, materials)
        self.model.geom(face.geom).matid = self.model.material(materials[expression]).id

    def effort(self) -> float:
        """Return the effort of the actuators in the last physics step, for a task to subtract from its reward.

        This is the sum of u² T, divided by n times the sum of T, over n actuators with peak torques T, where u is the
        fraction of the peak torque in use or, for muscles, the activation. It is zero for position actuators.
        """
        return self._act.effort(self.data)

    def keypoints(self) -> npt.NDArray[np.float64]:
        """Return the BODY_25 keypoints in the world frame, shape (25, 3), [m]; those of missing limbs are NaN."""
        found = np.full((len(self.manifest.keypoints), 3), np.nan)
        present = self._keypoints >= 0
        found[present] = self.data.site_xpos[self._keypoints[present]]
        return found

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict]:
        """Start an episode in the bundle's default pose, or in another: `options={"pose": name}`.

        An environment made from a spec can also change its scene: `options={"scene_seed": N}`.

        Raises:
            UnknownNameError: If there is no such pose or option.
            ValueError: If the seed is not a non-negative integer.
        """
        super().reset(seed=seed)
        if seed is not None:
            self._noise.restart(seed)
        options = options or {}
        known = ["pose", *(["scene_seed"] if self._next_bundle else [])]
        for key in options.keys() - known:
            raise UnknownNameError("reset option", str(key), known)
        pose = pose_of(self.manifest, options.get("pose", self.manifest.pose))
        if "scene_seed" in options:
            self._change_scene(options["scene_seed"])
        observation = self._start(pose)
        self._renderer.show()
        return observation, {"is_success": False, "reward_terms": {}, "unstable": False}

    def step(self, action: npt.NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Apply an action for one control step; values outside the action space are clipped.

        Raises:
            ValueError: If the action has the wrong shape or is not finite.
        """
        self._schedule.step(action, self.data)
        judged = self.judge(action, unstable=broke_down(self.data))
        observation = self._observe()
        if judged[-1]["unstable"]:
            for reading in observation.values():
                np.nan_to_num(reading, copy=False)
        self._renderer.show()
        return observation, *judged

    def judge(self, action: npt.NDArray[np.float32], *, unstable: bool) -> tuple[float, bool, bool, dict[str, Any]]:
        """Count a control step that has been made: return reward, terminated, truncated and info."""
        self._steps += 1
        verdict = NO_REWARD if unstable else self._task.judge(self.data, action, self.effort)
        truncated = self._task.steps is not None and self._steps >= self._task.steps
        info = {"is_success": verdict.success, "reward_terms": dict(verdict.reward_terms), "unstable": unstable}
        return verdict.reward, verdict.terminated or unstable, truncated, info

    def get_state(self) -> dict[str, Any]:
        """Return the complete state of the environment: physics, delayed signals, noise, task and random generator.

        The state consists of arrays, lists and dictionaries that are independent of the environment and can be pickled.
        """
        physics = np.empty(mujoco.mj_stateSize(self.model, STATE))
        mujoco.mj_getState(self.model, self.data, physics, STATE)
        return copy.deepcopy(
            {
                "physics": physics,
                "signals": self._schedule.state,
                "model": self._model_fields.state,
                "task": self._task.state,
                "steps": self._steps,
                "random": self.np_random.bit_generator.state,
                "noise": self._noise.state,
                "scene_seed": self.manifest.seed,
            }
        )

    def set_state(self, state: dict[str, Any]) -> Observation:
        """Restore a state of this environment, or of another one of the same bundle; return the observation.

        All later steps are exactly as they would have been from there. Derived quantities (contacts, positions of
        bodies) are those of the restored state, whereas after a step MuJoCo leaves those of one physics step before.

        An environment made from a spec also restores the scene of the state.

        Raises:
            ValueError: If the state is that of a different infant, or of a scene that this environment cannot restore.
        """
        if state["scene_seed"] != self.manifest.seed:
            if self._next_bundle is None:
                raise ValueError(
                    f"state has scene_seed {state['scene_seed']}, but this environment has {self.manifest.seed} and was"
                    " not made from a spec, so it cannot change its scene"
                )
            self._change_scene(state["scene_seed"])
        if np.shape(state["physics"]) != (mujoco.mj_stateSize(self.model, STATE),):
            raise ValueError("state does not fit this infant: the size of its model's state is different")
        state = copy.deepcopy(state)
        self._model_fields.state, self._task.state, self._steps = state["model"], state["task"], state["steps"]
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, state["physics"], STATE)
        mujoco.mj_forward(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, state["physics"], STATE)  # The solver's warm start, as it was.
        self._schedule.state = state["signals"]
        self.np_random.bit_generator.state, self._noise.state = state["random"], state["noise"]
        return self._observe()

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Return an image of the infant, shape (height, width, 3), in render mode `rgb_array`, otherwise None.

        Raises:
            RenderingError: If OpenGL is not available.
        """
        return self._renderer.render()

    def close(self) -> None:
        """Free the OpenGL contexts and close the window, if there are any."""
        for sense in self._senses.values():
            sense.close()
        self._renderer.close()

    def __getstate__(self) -> dict[str, Any]:
        """Support copying and pickling: leave out everything that is bound to this environment's model."""
        kept = {name: value for name, value in self.__dict__.items() if name not in BOUND}
        return {**kept, "model": copy.copy(self.model), "state": self.get_state()}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        """Bind the copy to its own model and restore the state of the original."""
        state = kept.pop("state")
        self.__dict__.update(kept)
        self._noise = NoiseStreams(self.np_random_seed)
        self._bind()
        self.set_state(state)

    def _bind(self, former: Mapping[str, Sense] = MappingProxyType({})) -> None:
        """Look up in the model everything the manifest names, reusing resources of *former* senses, and reset."""
        self.data = mujoco.MjData(self.model)
        self._act = bind_actuation(self.manifest.actuation, self.model)
        self._senses = bind_senses(self.bundle, self.model, former, self._custom_senses)
        self._constraints = Constraints(self.manifest.constraints, self.model)
        self._task = (
            bind_task(self.bundle, self.model)
            if self._custom_task is None
            else CustomTask(self._custom_task, self.model, self.bundle)
        )
        fields = (*self._constraints.model_fields, *self._task.model_fields)
        self._model_fields = ModelFields(self.model, fields)
        self._schedule = Schedule(self._senses, self._act, self.model, self._timing(), self._noise)
        site = mujoco.mjtObj.mjOBJ_SITE
        self._keypoints = np.array([mujoco.mj_name2id(self.model, site, name) for name in self.manifest.keypoints], int)
        self._start(self.manifest.pose)
        root_body = self.manifest.root_body
        self._renderer = EnvRenderer(self.render_mode, self.model, self.data, root_body, self._picture_size)
        low, high = (bound.astype(np.float32) for bound in (self._act.low, self._act.high))
        self.action_space = gymnasium.spaces.Box(low, high, dtype=np.float32)
        spaces = {name: space for part in (*self._senses.values(), self._task) for name, space in part.spaces.items()}
        self.observation_space = gymnasium.spaces.Dict(spaces)

    def _timing(self) -> Timing:
        """Return the time base, the noise, and the delays of the bundle's signals and of senses passed as objects."""
        delays = {name: delay for name, delay in self.manifest.delays if name != "legs"}
        custom = {name: sense.delay for name, sense in self._senses.items() if isinstance(sense, CustomSense)}
        manifest = self.manifest
        return Timing(manifest.step_ms, manifest.timestep_ms, delays | custom, manifest.delays.legs, manifest.noise)

    def _change_scene(self, seed: int) -> None:
        """Put the infant into another scene."""
        if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
            raise ValueError(f"expected a non-negative integer as scene_seed, got {seed!r}")
        if self._next_bundle is not None and seed != self.manifest.seed:
            bundle = self._next_bundle(int(seed))
            model = load_model(bundle)
            self._renderer.close()
            self.bundle, self.model = bundle, model
            self._bind(self._senses)

    def _start(self, pose: str) -> Observation:
        """Put the infant into a pose, at rest, start its task, and return the observation."""
        self._steps = 0
        mujoco.mj_resetDataKeyframe(self.model, self.data, self.model.key(pose).id)
        mujoco.mj_kinematics(self.model, self.data)
        self._constraints.keep(self.data)
        mujoco.mj_forward(self.model, self.data)
        self._task.start(self.data, self.np_random)
        self._schedule.reset(self.data)
        return self._observe()

    def _observe(self) -> Observation:
        """Return what the senses and the task give, as fresh arrays."""
        observation = self._schedule.observe()
        return {**observation, **self._task.observe()} if self._task.spaces else observation

    def _sense(self, name: str) -> Sense:
        if name not in self._senses:
            raise UnknownNameError("sense of this infant", name, self._senses)
        return self._senses[name]


BOUND = {
    "_noise",
    "data",
    "_act",
    "_senses",
    "_constraints",
    "_task",
    "_model_fields",
    "_schedule",
    "_keypoints",
    "_renderer",
}
"""Attributes that are not copied but bound anew."""


def make(bundle: Bundle | str | Path, **options: Any) -> gymnasium.Env:
    """Return the environment of a bundle, as `gymnasium.make("mimoc/Infant-v0", bundle=..., **options)` does."""
    return gymnasium.make("mimoc/Infant-v0", bundle=bundle, **options)
