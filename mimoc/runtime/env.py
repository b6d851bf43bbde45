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
from mimoc.delays.schedule import Schedule, Timing
from mimoc.errors import UnknownNameError
from mimoc.render.environment import MODES, EnvRenderer, available_modes
from mimoc.runtime.fastenings import Fastenings
from mimoc.senses.binding import bind_senses
from mimoc.senses.custom import CustomSense
from mimoc.senses.sense import Observation, Sense
from mimoc.tasks.binding import bind_task
from mimoc.tasks.custom import CustomTask
from mimoc.tasks.task import NOTHING_EARNED
from mimoc.units import ms_to_s

if TYPE_CHECKING:  # It needs SciPy, which most environments do without.
    from mimoc.senses.touch.run import SkinState

STATE = mujoco.mjtState.mjSTATE_INTEGRATION
"""All that MuJoCo's future depends on."""


class InfantEnv(gymnasium.Env[Any, npt.NDArray[np.float32]]):
    """An infant in its world.

    Observation: a dictionary with one float32 array for each of proprioception, vestibular sense and touch and one
    uint8 picture, shape (H, W, 3), for each eye; `nothing`, a zero, for an infant without senses.
    Action: one Box, a command for each actuator that takes commands.
    Reward and end are those of the bundle's task, and an episode is cut off (truncated) after the task's steps; without
    a task the reward is zero and there is no end. An episode also ends if the simulation becomes unstable. `info` has
    `is_success`, the terms that add up to the reward as `reward_terms`, and `unstable`.
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
            bundle: A bundle, or the folder of one.
            render_mode: `human` for a window that shows every step, `rgb_array` for pictures from `render()`.
            width: Of the pictures, in pixels.
            height: Of the pictures, in pixels.
            next_bundle: Returns the same infant in another scene, by its seed, for `reset`.
            task: An object to take the place of the bundle's task; see `tasks.custom.CustomTask`.
            senses: Objects to sense with besides the bundle's senses, by name; see `senses.custom.CustomSense`.

        Raises:
            BundleError: If the folder is not a whole bundle.
            ModelError: If MuJoCo refuses its model.
            RenderingError: If the infant sees or shows itself, and there is no OpenGL or no screen for that here.
            UnknownNameError: If there is no such render mode.
            KindError: If a sense that is passed has the name of one that the infant has.
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
        self._bind()

    @property
    def manifest(self) -> Manifest:
        """What the compiler says of this infant."""
        return self.bundle.manifest

    @property
    def actuation(self) -> Actuation:
        """What turns actions into controls: its actuators, in the order of the action, and their limits."""
        return self._act

    @property
    def max_steps(self) -> int | None:
        """Control steps after which an episode is truncated; None is never."""
        return self._task.steps

    def layout(self, sense: str) -> tuple[str, ...]:
        """Return what each number of a sense is, with its unit, in the order of the observation.

        Raises:
            UnknownNameError: If this infant has no such sense.
        """
        return self._sense(sense).layout

    @property
    def skin(self) -> "SkinState":
        """Where the skin points are, in the body of which, and the force on each of them now, without delay.

        Raises:
            UnknownNameError: If this infant has no sense of touch.
        """
        touch: Any = self._sense("touch")
        return touch.skin_state(self.data)

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

        An environment that was made from a spec can also get another scene: `options={"scene_seed": N}`.

        Raises:
            UnknownNameError: If there is no such pose or option.
            ValueError: If the seed is no whole number from 0 on.
        """
        super().reset(seed=seed)
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
        """Apply an action for one control step; what lies beyond its range is clipped.

        Raises:
            ValueError: If the action is not one number for each actuator.
        """
        self._schedule.step(action, self.data)
        self._steps += 1
        unstable = broke_down(self.data)
        verdict = NOTHING_EARNED if unstable else self._task.judge(self.data, action, self.effort)
        observation = self._observe()
        if unstable:
            for reading in observation.values():
                np.nan_to_num(reading, copy=False)
        self._renderer.show()
        late = self._task.steps is not None and self._steps >= self._task.steps
        info = {"is_success": verdict.success, "reward_terms": dict(verdict.terms), "unstable": unstable}
        return observation, verdict.reward, verdict.ends or unstable, late, info

    def get_state(self) -> dict[str, Any]:
        """Return all that the future depends on: physics, signals on their way, and chance.

        It is made of arrays, lists and dictionaries of its own, which can be kept, pickled and sent elsewhere.
        """
        physics = np.empty(mujoco.mj_stateSize(self.model, STATE))
        mujoco.mj_getState(self.model, self.data, physics, STATE)
        chance = self.np_random.bit_generator.state
        return copy.deepcopy(
            {
                "physics": physics,
                "signals": self._schedule.state,
                "fastenings": self._fastenings.state,
                "task": self._task.state,
                "steps": self._steps,
                "chance": chance,
                "scene_seed": self.manifest.seed,
            }
        )

    def set_state(self, state: dict[str, Any]) -> Observation:
        """Go back to a state of this infant, or of another environment of the same bundle; return what it observes.

        Everything that follows is then as it was. What is derived from a state (contacts, places of bodies) is that
        of the state itself, while after a step it is that of one physics step before, as MuJoCo leaves it.

        An environment that was made from a spec goes back to the scene of the state, too.

        Raises:
            ValueError: If it is not a state of such an infant, or of another scene than this environment has.
        """
        if state["scene_seed"] != self.manifest.seed:
            if self._next_bundle is None:
                raise ValueError(f"this is a state of scene {state['scene_seed']}; here is scene {self.manifest.seed}")
            self._change_scene(state["scene_seed"])
        if np.shape(state["physics"]) != (mujoco.mj_stateSize(self.model, STATE),):
            raise ValueError("this is the state of another infant, whose model has other parts")
        state = copy.deepcopy(state)
        self._fastenings.state, self._task.state, self._steps = state["fastenings"], state["task"], state["steps"]
        mujoco.mj_resetData(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, state["physics"], STATE)
        mujoco.mj_forward(self.model, self.data)
        mujoco.mj_setState(self.model, self.data, state["physics"], STATE)  # The solver's warm start, as it was.
        self._schedule.state = state["signals"]
        self.np_random.bit_generator.state = state["chance"]
        return self._observe()

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Return a picture of the infant, shape (height, width, 3), in render mode `rgb_array`; else None.

        Raises:
            RenderingError: If there is no OpenGL here.
        """
        return self._renderer.render()

    def close(self) -> None:
        """Free the OpenGL contexts and close the window, if there are any."""
        for sense in self._senses.values():
            sense.close()
        self._renderer.close()

    def __getstate__(self) -> dict[str, Any]:
        """Let the environment be copied and sent to other processes: what is bound to this one is left out."""
        kept = {name: value for name, value in self.__dict__.items() if name not in BOUND}
        return {**kept, "model": copy.copy(self.model), "state": self.get_state()}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        """Bind a copy anew, and take up where the original was."""
        state = kept.pop("state")
        self.__dict__.update(kept)
        self._bind()
        self.set_state(state)

    def _bind(self, former: Mapping[str, Sense] = MappingProxyType({})) -> None:
        """Find everything the manifest names in the model, once, and start; senses from before are taken along."""
        self.data = mujoco.MjData(self.model)
        self._act = bind_actuation(self.manifest.actuation, self.model)
        self._senses = bind_senses(self.bundle, self.model, former, self._custom_senses)
        self._fastenings = Fastenings(self.manifest.fastenings, self.model)
        self._task = (
            bind_task(self.bundle, self.model, self._fastenings)
            if self._custom_task is None
            else CustomTask(self._custom_task, self.model, self.bundle)
        )
        self._schedule = Schedule(self._senses, self._act, self.model, self._timing())
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
        """Return the time base, and the delays of the bundle's signals and of senses that were passed as objects."""
        delays = {name: delay for name, delay in self.manifest.delays if name != "legs"}
        custom = {name: sense.delay for name, sense in self._senses.items() if isinstance(sense, CustomSense)}
        return Timing(self.manifest.step_ms, self.manifest.timestep_ms, delays | custom, self.manifest.delays.legs)

    def _change_scene(self, seed: int) -> None:
        """Put the infant into another scene."""
        if isinstance(seed, bool) or not isinstance(seed, (int, np.integer)) or seed < 0:
            raise ValueError(f"a scene's seed is a whole number from 0 on, not {seed!r}")
        if self._next_bundle is not None and seed != self.manifest.seed:
            bundle = self._next_bundle(int(seed))
            model = load_model(bundle)
            self._renderer.close()
            self.bundle, self.model = bundle, model
            self._bind(self._senses)

    def _start(self, pose: str) -> Observation:
        """Put the infant into a pose, at rest, set out its task, and return what it observes."""
        self._steps = 0
        mujoco.mj_resetDataKeyframe(self.model, self.data, self.model.key(pose).id)
        mujoco.mj_kinematics(self.model, self.data)
        self._fastenings.keep(self.data)
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


BOUND = {"data", "_act", "_senses", "_fastenings", "_task", "_schedule", "_keypoints", "_renderer"}
"""What an environment cannot give to a copy of itself."""


def make(bundle: Bundle | str | Path, **options: Any) -> gymnasium.Env:
    """Return the environment of a bundle, as `gymnasium.make("mimoc/Infant-v0", bundle=..., **options)` does."""
    return gymnasium.make("mimoc/Infant-v0", bundle=bundle, **options)
