"""MIMo3's base environment on mimoc's runtime."""

import copy
from typing import Any, Literal

import gymnasium
import mujoco
import numpy as np
import numpy.typing as npt
from gymnasium.spaces import Box, Dict, Space

from mimoc.base.errors import MimocError, check_name
from mimoc.compat.mimo3.keywords import BENCHMARK_XML, Keywords, spec_of
from mimoc.compat.mimo3.modules import (
    ActuationModel,
    SimpleProprioception,
    SimpleVestibular,
    SimpleVision,
    TrimeshTouch,
    model_named,
    model_of,
)
from mimoc.render.renderer import Renderer
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.opening import open_infant

NEVER_CALLED = {
    "_substep_callback": "set frame_skip=1 and use _step_callback",
    "_single_mujoco_step": "override do_simulation",
    "_initialize_simulation": "change the spec, or the model after super().__init__()",
    "_delayed_action": "give motor_delay",
    "_delayed_observation": "give sensory_delay",
}
"""Methods of MIMo3's that nothing calls, and what to do instead."""
ABSENT = {
    "mimo_joints": "those in proprioception.sensor_names are the infant's",
    "mujoco_renderer": "call render(), or draw model and data with mujoco.Renderer",
    "sim": "use model and data",
    "fullpath": "the infant is built in memory; mimoc.write_bundle(env.infant.bundle, folder) writes it",
}
"""Attributes of MIMo's that are not there, and what to use instead."""


class MIMoEnv(gymnasium.Env[Any, npt.NDArray[Any]]):
    """An infant of mimoc's with MIMo3's keywords, attributes and methods to override.

    The spec that the keywords ask for is built, and `infant` is its `mimoc.InfantEnv`. Goals, rewards and ends of
    episodes are those of the spec's task until a subclass overrides the methods for them.

    Senses are sampled within `do_simulation`: what `_step_callback` changes is observed after the next step.
    """

    metadata = {"render_modes": ["human", "rgb_array"], "render_fps": 100}  # noqa: RUF012 - Gymnasium's own attribute.
    infant: InfantEnv
    actuation_model: ActuationModel
    proprioception: Any = None
    touch: Any = None
    vision: Any = None
    vestibular: Any = None

    def __init__(
        self,
        model_path: Any = BENCHMARK_XML,
        initial_qpos: dict[str, Any] | None = None,
        frame_skip: int = 2,
        sensory_delay: int = 0,
        motor_delay: int = 0,
        render_mode: Literal["human", "rgb_array"] | None = None,
        camera_id: int | None = None,
        camera_name: str | None = None,
        width: int = 500,
        height: int = 500,
        default_camera_config: dict[str, Any] | None = None,
        age: float | None = None,
        custom_measurements: dict[Any, float] | None = None,
        proprio_params: dict[str, Any] | None = None,
        touch_params: dict[str, Any] | None = None,
        vision_params: dict[str, Any] | None = None,
        vestibular_params: dict[str, Any] | None = None,
        actuation_model: Any = None,
        goals_in_observation: bool = True,
        done_active: bool = False,
    ):
        """Build the infant and open it; `docs/from_mimo.md` has the keywords one by one.

        Raises:
            MimocError: If a keyword has no counterpart, or there is no such infant.
        """
        for name, advice in NEVER_CALLED.items():
            if getattr(type(self), name, None) is not getattr(MIMoEnv, name, None):
                raise MimocError(f"{type(self).__name__}.{name} would never be called here; {advice}")
        kind = model_named(actuation_model)
        senses = (proprio_params, touch_params, vision_params, vestibular_params)
        times = frame_skip, sensory_delay, motor_delay
        spec = spec_of(Keywords(model_path, age, custom_measurements, *times, *senses, kind and kind.model))
        self.frame_skip, self.sensory_delay, self.motor_delay = times
        self.age, self.goals_in_observation, self.done_active = age, goals_in_observation, done_active
        self.proprio_params, self.touch_params, self.vision_params, self.vestibular_params = senses
        self.render_mode, self.width, self.height = render_mode, width, height
        self.camera_id, self.camera_name, self._camera_config = camera_id, camera_name, default_camera_config
        self._camera: Renderer | None = None
        self.infant = open_infant(spec, render_mode=render_mode, width=width, height=height)
        self.metadata = {**type(self).metadata, "render_fps": self.infant.metadata["render_fps"]}
        self._initial_qpos = initial_qpos
        self.actuation_model = (kind or model_of(spec.actuation.model))(self)
        self.action_space: Any = self.actuation_model.get_action_space()
        self._start(senses)

    def _start(self, senses: Any) -> None:
        self._is_resetting = True
        self._judged: Any = (0.0, False, False, {"is_success": False, "reward_terms": {}, "unstable": False})
        self._set_initial_position()
        self._env_setup(senses)
        self.goal = self.sample_goal()
        self.observation_space: Any = Dict({name: self._space(name, array) for name, array in self._get_obs().items()})

    def _env_setup(self, params: Any) -> None:
        self._sense()
        self.proprio_setup(params[0])
        for name, given in zip(("touch", "vision", "vestibular"), params[1:], strict=True):
            if getattr(self.infant.manifest.senses, name) is not None:
                getattr(self, f"{name}_setup")(given)

    def _set_initial_position(self) -> None:
        """Put joints where `initial_qpos` has them, and remember the start of the episode."""
        for name, position in (self._initial_qpos or {}).items():
            check_name("joint", name, [self.model.joint(index).name for index in range(self.model.njnt)])
            self.data.joint(name).qpos[:] = position
        mujoco.mj_forward(self.model, self.data)
        self.init_qpos, self.init_qvel = self.data.qpos.copy(), self.data.qvel.copy()

    def _space(self, name: str, array: Any) -> Space[Any]:
        """Return the space of an observation, with mimoc's bounds where it is mimoc's."""
        spaces: Any = self.infant.observation_space
        order = getattr(self.proprioception, "order", None)
        if name == "observation" and order is not None and array.shape == order.shape:
            return Box(spaces["proprioception"].low[order], spaces["proprioception"].high[order], dtype=np.float32)
        if name in spaces.spaces and spaces[name].shape == array.shape:
            return spaces[name]
        return Box(-np.inf, np.inf, np.shape(array), np.asarray(array).dtype.type)

    # What is there.

    @property
    def model(self) -> mujoco.MjModel:
        """MuJoCo's model."""
        return self.infant.model

    @property
    def data(self) -> mujoco.MjData:
        """MuJoCo's state."""
        return self.infant.data

    @property
    def dt(self) -> float:
        """Duration of a control step, [s]."""
        return self.model.opt.timestep * self.frame_skip

    @property
    def mimo_actuators(self) -> npt.NDArray[np.intp]:
        """Indices of the actuators that take commands."""
        return self.infant.actuation.actuators

    @property
    def facial_expressions(self) -> dict[str, str]:
        """The names for `swap_facial_expression`, and mimoc's names for them."""
        names = self.infant.manifest.face.materials if self.infant.manifest.face else ()
        return {"default" if name == "neutral" else name: name for name in names}

    def __getattr__(self, name: str) -> Any:
        advice = ABSENT.get(name, "see docs/from_mimo.md, or use .infant, the mimoc.InfantEnv below")
        raise AttributeError(f"'{type(self).__name__}' of mimoc.compat.mimo3 has no attribute '{name}'; {advice}")

    def __getstate__(self) -> dict[str, Any]:
        """Support copying and pickling: leave out what draws."""
        return {**self.__dict__, "_camera": None}

    # What users override.

    def reset_model(self) -> Any:
        """Start an episode; it already has mimoc's pose, task and `initial_qpos`. Return the observation."""
        return self._get_obs()

    def sample_goal(self) -> Any:
        """Return the goal of an episode."""
        return np.zeros(0)

    def get_achieved_goal(self) -> Any:
        """Return what is achieved of it."""
        return np.zeros(np.shape(self.goal))

    def compute_reward(self, achieved_goal: Any, desired_goal: Any, info: dict[str, Any]) -> float:
        """Return the reward of the step that was made: that of the spec's task, if it has one."""
        return self._judged[0]

    def is_success(self, achieved_goal: Any, desired_goal: Any) -> bool:
        """Return whether the goal of the spec's task is reached."""
        return self._judged[3]["is_success"]

    def is_failure(self, achieved_goal: Any, desired_goal: Any) -> bool:
        """Return whether the spec's task is over without success."""
        return self._judged[1] and not self._judged[3]["is_success"]

    def is_truncated(self) -> bool:
        """Return whether the episode ends for another reason; Gymnasium's limit of its id is not one of those."""
        return False

    def _is_done(self, achieved_goal: Any, desired_goal: Any, info: dict[str, Any]) -> tuple[bool, bool]:
        return bool(self.done_active and (info["is_success"] or info["is_failure"])), bool(self.is_truncated())

    def _step_callback(self) -> None:
        """Do something after each control step."""

    def _obs_callback(self) -> None:
        """Do something after each observation."""

    def proprio_setup(self, proprio_params: Any) -> None:
        """Set `proprioception`."""
        self.proprioception = SimpleProprioception(self, proprio_params)

    def touch_setup(self, touch_params: Any) -> None:
        """Set `touch`."""
        self.touch = TrimeshTouch(self, touch_params)

    def vision_setup(self, vision_params: Any) -> None:
        """Set `vision`."""
        self.vision = SimpleVision(self, vision_params)

    def vestibular_setup(self, vestibular_params: Any) -> None:
        """Set `vestibular`."""
        self.vestibular = SimpleVestibular(self, vestibular_params)

    def get_proprio_obs(self) -> Any:
        """Return what is observed as `observation`."""
        return self.proprioception.get_proprioception_obs()

    def get_touch_obs(self) -> Any:
        """Return what is observed as `touch`."""
        return self.touch.get_touch_obs()

    def get_vision_obs(self) -> Any:
        """Return the pictures of the eyes, by name."""
        return self.vision.get_vision_obs()

    def get_vestibular_obs(self) -> Any:
        """Return what is observed as `vestibular`."""
        return self.vestibular.get_vestibular_obs()

    def _get_obs(self) -> dict[str, Any]:
        """Return the observation; while an episode starts, of the present state."""
        if self._is_resetting:
            self._sense()
        observation = {"observation": self.get_proprio_obs()}
        if self.touch:
            observation["touch"] = self.get_touch_obs().ravel()
        if self.vision:
            observation.update(self.get_vision_obs())
        if self.vestibular:
            observation["vestibular"] = self.get_vestibular_obs()
        if self.goals_in_observation:
            observation["achieved_goal"] = np.array(self.get_achieved_goal(), np.float64)
            observation["desired_goal"] = np.array(self.goal, np.float64)
        return observation

    # What happens.

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start an episode."""
        super().reset(seed=seed)
        _, info = self.infant.reset(seed=seed, options=options)
        self._is_resetting = True
        self._set_initial_position()
        self.goal = self.sample_goal()
        observation = self.reset_model()
        self._is_resetting = False
        return observation, info

    def step(self, action: npt.NDArray[Any]) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Make a control step; `info` also has what mimoc's has, such as `reward_terms`."""
        self._is_resetting = False
        self.do_simulation(action, self.frame_skip)
        self._step_callback()
        observation = self._get_obs()
        self._obs_callback()
        achieved, goal = self.get_achieved_goal(), self.goal
        info = dict(self._judged[3])
        info |= {"is_success": self.is_success(achieved, goal), "is_failure": self.is_failure(achieved, goal)}
        if not self.goals_in_observation:
            info |= {"achieved_goal": copy.deepcopy(achieved), "desired_goal": copy.deepcopy(goal)}
        terminated, truncated = self._is_done(achieved, goal, info)
        reward = float(self.compute_reward(achieved, goal, info))
        return observation, reward, terminated or info["unstable"], truncated, info

    def do_simulation(self, action: npt.NDArray[Any], n_frames: int) -> None:
        """Make a control step of `frame_skip` physics steps, or another number of them without senses or delays."""
        if n_frames != self.frame_skip or self._is_resetting:
            self._set_action(action)
            mujoco.mj_step(self.model, self.data, n_frames)
            return
        self.sensed, *self._judged = self.infant.step(self.actuation_model.command(action).astype(np.float32))

    def set_state(self, qpos: npt.NDArray[Any], qvel: npt.NDArray[Any]) -> None:
        """Set positions and velocities."""
        if np.shape(qpos) != (self.model.nq,) or np.shape(qvel) != (self.model.nv,):
            raise ValueError(f"expected {self.model.nq} positions and {self.model.nv} velocities")
        self.data.qpos[:], self.data.qvel[:] = qpos, qvel
        mujoco.mj_forward(self.model, self.data)

    def swap_facial_expression(self, emotion: str) -> None:
        """Change the facial expression to one of `facial_expressions`."""
        check_name("facial expression", emotion, self.facial_expressions)
        self.infant.set_expression(self.facial_expressions[emotion])

    def render(self) -> Any:
        """Return a picture by the camera that was chosen, else by one that follows the infant; see `InfantEnv`."""
        if self.render_mode != "rgb_array" or (self.camera_id, self.camera_name, self._camera_config) == (None,) * 3:
            return self.infant.render()
        self._camera = self._camera or Renderer(self.model, self.width, self.height)
        with self._camera.in_use():
            self._camera.compose(self.data, self._view())
            self._camera.draw()
            return self._camera.read()[::-1].copy()

    def close(self) -> None:
        """Free what draws."""
        self.infant.close()
        if self._camera:
            self._camera.close()

    def _view(self) -> mujoco.MjvCamera:
        camera = mujoco.MjvCamera()
        if self.camera_name is not None or self.camera_id is not None:
            index = self.model.camera(self.camera_name).id if self.camera_name else self.camera_id
            camera.type = mujoco.mjtCamera.mjCAMERA_FIXED
            camera.fixedcamid = index
            return camera
        for name, value in (self._camera_config or {}).items():
            setattr(camera, name, value)
        return camera

    def _set_action(self, action: npt.NDArray[Any]) -> None:
        self.actuation_model.action(action)

    def _single_mujoco_step(self) -> None:
        mujoco.mj_step(self.model, self.data)

    def _sense(self) -> None:
        self.infant.schedule.reset(self.data)
        self.sensed = self.infant.schedule.observe()
