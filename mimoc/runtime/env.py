"""The Gymnasium environment around a compiled infant."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Literal

import gymnasium
import numpy as np
import numpy.typing as npt

from mimoc.base.state_form import require
from mimoc.base.units import ms_to_s
from mimoc.bundle.io import Bundle
from mimoc.bundle.variants import Variant, Variants, open_variant
from mimoc.render.environment import MODES, available_modes, check_rendering
from mimoc.runtime import growing
from mimoc.runtime.closing import closable
from mimoc.runtime.growing import SEED
from mimoc.runtime.gymnasium_forms import limited_spec
from mimoc.runtime.infant import AGE, PHYSICS, Custom, Infant
from mimoc.runtime.noise import NoiseStreams
from mimoc.runtime.sense import NOTHING, Observation
from mimoc.runtime.simulation import BEFORE, INFANTS, Pictures, Simulation


@closable()
class InfantEnv(Infant, gymnasium.Env[Any, npt.NDArray[np.float32]]):
    """An infant that is alone in its scene, as an environment of Gymnasium: a world of one.

    Observation: a dictionary with one float32 array for each of proprioception, vestibular sense and touch, and one
    uint8 image, shape (H, W, 3), for each eye; an infant without senses observes `nothing`, a single zero.
    Action: a Box with one command for each commanded actuator.
    Reward and termination are those of the bundle's task, and episodes are truncated after the task's number of steps;
    without a task the reward is zero and episodes do not end. An episode also terminates if the simulation becomes
    unstable. `info` contains `is_success`, the terms of the reward as `reward_terms`, and `unstable`.
    """

    metadata = {"render_modes": [*MODES], "render_fps": 100}  # noqa: RUF012 - Gymnasium's own attribute.
    closed = False
    spec: Any = limited_spec(lambda env: (env.max_steps,))

    def __init__(
        self,
        bundle: Bundle | Variant | str | Path,
        render_mode: Literal["human", "rgb_array"] | None = None,
        width: int = 480,
        height: int = 480,
        variants: Variants | None = None,
        task: Any = None,
        senses: Mapping[str, Any] = NOTHING,
        companions: Mapping[str, Any] = NOTHING,
    ):
        """Open a bundle.

        Args:
            bundle: A bundle, or a bundle folder; or one with its model.
            render_mode: `human` for a window that is updated at every step, `rgb_array` for images from `render()`.
            width: Width of the images, in pixels.
            height: Height of the images, in pixels.
            variants: Makes the same infant at another age or in the scene of another seed, for `grow` and `reset`.
            task: Object that replaces the bundle's task; see `mimoc.runtime.task`.
            senses: Objects that are added to the bundle's senses, by name; see `mimoc.runtime.sense`.
            companions: Objects that act in its world as well, by name; see `mimoc.Companion`.

        Raises:
            BundleError: If the folder is not an intact bundle.
            ModelError: If MuJoCo rejects its model.
            RenderingError: If vision or the render mode needs OpenGL or a display that is not available.
            UnknownNameError: If there is no such render mode.
            ValueError: If the images have no size that images can have.
            KindError: If the task, a sense or a companion is no such object, or has the name of an existing one.
        """
        check_rendering(render_mode, width, height)
        self.render_mode = render_mode
        self._custom = Custom.checked(task, senses, companions)
        variant = open_variant(bundle)
        manifest = variant.bundle.manifest
        self.metadata = {"render_modes": available_modes(), "render_fps": round(1 / ms_to_s(manifest.step_ms))}
        self.noise = NoiseStreams(self.np_random_seed)
        draws = bool(render_mode) or self._custom.is_any or growing.sees_skin(manifest)
        pictures = Pictures(render_mode, width, height)
        self.simulation = Simulation(variant, {"": self}, variants, pictures, draws=draws)

    @property
    def random(self) -> np.random.Generator:  # pyright: ignore[reportIncompatibleVariableOverride] - Gymnasium's.
        """Random numbers of its task: those of Gymnasium's environments."""
        return self.np_random

    def draw_from(self, seed: int) -> None:
        """Draw random numbers from this seed on."""
        super().reset(seed=seed)
        self.noise.restart(seed)

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Observation, dict]:
        """Start an episode in the bundle's default pose, or in another: `options={"pose": name}`.

        Other options: `age_months`, from now on; `scene_seed`, if it was made from a spec; `arousal`, where 0 is slack;
        and `objects`, which are elsewhere in this episode: `{"ball": {"x_cm": 20, "y_cm": 10}}` (docs/objects.md).

        Raises:
            UnknownNameError: If there is no such pose or option.
            TypeError: If the options are no dictionary.
            ValueError: If a seed, an age, an arousal or the place of an object is none that there can be.
            MimocError: If there is no such infant; nothing has changed then.
        """
        return self.simulation.reset({"": seed}, {"": growing.options_given(options)})[""]

    def grow(self, to: float) -> Observation:
        """Let the infant have another age from now on, in the midst of its episode; return the observation.

        It stays where it is and moves on as it moved: joint angles are kept as far as its joints reach now, and so are
        velocities, objects around it, its task, signals on their way, its expression and random state. Size, strength,
        joints, delays, acuity, skin and face are those of its new age. It is lifted out of what it would sink into.

        Args:
            to: The new age, in months, from 0 to 24; a younger one, too.

        Raises:
            ValueError: If this is not such an age.
            MimocError: If there is no such infant, or this environment cannot make it; nothing has changed then.
        """
        self.simulation.grow({"": to})
        return self.observe()

    def step(self, action: npt.NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Apply an action for one control step; values outside the action space are clipped.

        Raises:
            ValueError: If the action has the wrong shape or is not finite.
        """
        return self.simulation.step({"": action})[""]

    def get_state(self) -> dict[str, Any]:
        """Return the complete state: physics, delayed signals, noise, arousal, task and random generator.

        The state consists of arrays, lists and dictionaries that are independent of the environment and can be pickled.
        """
        state = self.simulation.get_state()
        return state | state.pop(INFANTS)[""]

    def set_state(self, state: dict[str, Any]) -> Observation:
        """Restore a state of this environment, or of another one of the same bundle; return the observation.

        All later steps are exactly as they would have been from there. Derived quantities (contacts, positions of
        bodies) are those of the restored state, whereas after a step MuJoCo leaves those of one physics step before.

        The age of the state is restored, and in an environment made from a spec, so is its scene.

        Raises:
            ValueError: If it is no state of this infant, or one that cannot be restored here; nothing has changed then.
            MimocError: If there is no such infant.
        """
        require(isinstance(state, Mapping) and {AGE, SEED, PHYSICS} <= state.keys(), "", state)
        whole = {name: state[name] for name in (PHYSICS, BEFORE, SEED) if name in state}
        self.simulation.set_state({**whole, INFANTS: {"": state}})
        return self.observe()

    def render(self) -> npt.NDArray[np.uint8] | None:
        """Return an image of the infant, shape (height, width, 3), in render mode `rgb_array`, otherwise None.

        Raises:
            RenderingError: If OpenGL is not available.
        """
        return self.simulation.render()

    def close(self) -> None:
        """Free the OpenGL contexts and close the window, if there are any; closing twice is fine.

        Its attributes, `layout` and `get_state` can still be read then, and a copy or a pickle gives an open one; all
        other methods raise Gymnasium's `ClosedEnvironmentError`.
        """
        self.simulation.close()

    def __getstate__(self) -> dict[str, Any]:
        kept = {name: value for name, value in self.__dict__.items() if name not in BOUND}
        return {**kept, "kept": self.simulation.kept()}

    def __setstate__(self, kept: dict[str, Any]) -> None:
        simulation = kept.pop("kept")
        self.__dict__.update(kept)
        self.noise = NoiseStreams(self.np_random_seed)
        self.simulation = Simulation.again(simulation, {"": self})


BOUND = {"simulation", "bundle", "binding", "_judged", "noise", "observer", "closed"}  # Not copied but bound anew.
