"""An infant that is bound to a model: what can be read of it, its face and arousal, and how its task judges it."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.actuation.binding import Actuation
from mimoc.base.errors import MimocError, check_name
from mimoc.bundle.io import Bundle
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.variants import Variant
from mimoc.companions.caregiver.run import Caregiver
from mimoc.companions.companion import Companions
from mimoc.delays.schedule import Schedule
from mimoc.runtime import growing
from mimoc.runtime.closing import closable
from mimoc.runtime.expression import set_expression
from mimoc.runtime.observer import NO_OBSERVER, Observer
from mimoc.runtime.simulation_state import SimulationState
from mimoc.senses.sense import Observation, Sense
from mimoc.tasks.judgement import NO_REWARD, check_judgement, reward_of
from mimoc.tasks.task import Task

if TYPE_CHECKING:  # It needs SciPy, which most environments do without.
    from mimoc.senses.touch.run import SkinState


@closable("layout")
class InfantView:
    """An infant as it is bound to its model, whatever else is there; who steps the model is another matter."""

    closed: bool
    bundle: Bundle
    data: mujoco.MjData
    observer: Observer = NO_OBSERVER
    _infant: Variant
    _act: Actuation
    _senses: Mapping[str, Sense]
    _task: Task
    _judged: Task | None = None
    """The task whose first judgement was as it must be."""
    _schedule: Schedule
    _living: SimulationState
    _steps: int

    @property
    def model(self) -> mujoco.MjModel:
        """MuJoCo's model, which may be changed; that of a growing infant gets its skin when it is asked for."""
        return self._infant.model

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
    def companions(self) -> Companions:
        """What else acts in its world, by name."""
        return self._schedule.companions

    @property
    def caregiver(self) -> Caregiver:
        """The adult by the infant.

        Raises:
            MimocError: If there is none.
        """
        companion = self.companions.get("caregiver")
        if not isinstance(companion, Caregiver):
            raise MimocError("this infant has no caregiver; add 'caregiver: {}' to the scene of its spec")
        return companion

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

    @property
    def age_months(self) -> float:
        """The infant's age."""
        return self.manifest.child.age_months

    def layout(self, sense: str) -> tuple[str, ...]:
        """Return the name and unit of each element of a sense's observation, in order.

        Raises:
            UnknownNameError: If this infant has no such sense.
        """
        check_name("sense of this infant", sense, self._senses)
        layout, of_infant = self._senses[sense].layout, self.manifest.of_infant
        return tuple(map(of_infant, layout)) if self.manifest.prefix else layout

    @property
    def skin(self) -> "SkinState":
        """The current positions, bodies and forces of all skin points, without delay.

        Raises:
            UnknownNameError: If this infant has no sense of touch.
        """
        check_name("sense of this infant", "touch", self._senses)
        touch: Any = self._senses["touch"]
        return touch.skin_state(self.data)

    def play(
        self, pressure_pa: npt.ArrayLike, sample_rate_hz: float, place_m: Sequence[float], body: str = "world"
    ) -> None:
        """Let a sound begin now, as from a loudspeaker, for an infant that hears.

        A recording does not contain it; what is to be simulated again lets a `Companion` sound.

        Args:
            pressure_pa: Sound pressure at 1 m, shape (n,), [Pa].
            sample_rate_hz: Samples per second.
            place_m: Its place in the frame of the body, shape (3,).
            body: The body of the model that it moves with.

        Raises:
            UnknownNameError: If this infant does not hear, or there is no such body.
            ValueError: If this is no sound or no place.

        Example:
            >>> import mimoc
            >>> import numpy as np
            >>> spec = mimoc.load_spec("nine_months.yaml").with_(senses={"hearing": {"output": "levels"}})
            >>> env = mimoc.make(spec).unwrapped
            >>> _ = env.reset(seed=0)
            >>> env.play(0.1 * np.sin(2 * np.pi * 1000 * np.arange(4800) / 24_000), 24_000, (0.0, 1.0, 0.2))
            >>> for _ in range(5):
            ...     observation = env.step(0 * env.action_space.sample())[0]
            >>> bool((observation["hearing"] > 20).all())  # [dB] above its threshold, at both ears.
            True
        """
        check_name("sense of this infant", "hearing", self._senses)
        check_name("body", body, [self.model.body(index).name for index in range(self.model.nbody)])
        hearing: Any = self._senses["hearing"]
        hearing.play(pressure_pa, sample_rate_hz, place_m, self.model.body(body).id, self.data)

    @property
    def arousal(self) -> float:
        """How much of its muscle tone the infant has: 0 is slack, 1 quiet."""
        return self._living.arousal.level

    def effort(self) -> float:
        """Return the effort of the actuators in the last physics step, for a task to subtract from its reward.

        This is the sum of u² T, divided by n times the sum of T, over n actuators with peak torques T, where u is the
        activation of a muscle, or the fraction of the peak torque in use, muscle tone included (docs/own_reward.md).
        """
        return self._act.cost(self.data)

    def keypoints(self) -> npt.NDArray[np.float64]:
        """Return the BODY_25 keypoints in the world frame, shape (25, 3), [m]; those of missing limbs are NaN."""
        names, site = self.manifest.keypoints, mujoco.mjtObj.mjOBJ_SITE
        sites = np.array([mujoco.mj_name2id(self._infant.bare, site, name) for name in names], int)
        return np.where(sites[:, None] < 0, np.nan, self.data.site_xpos[sites])

    def set_expression(self, expression: str) -> None:
        """Change the facial expression.

        Raises:
            UnknownNameError: If there is no such expression.
        """
        set_expression(expression, self._living.face, self._infant.bare)
        self.observer.expressed(expression)

    def set_arousal(self, level: float) -> None:
        """Change the arousal for the rest of the episode, from the next physics step on.

        Raises:
            ValueError: If it is none from 0 to 2.
        """
        self._living.arousal.level = level
        self.observer.aroused(level)

    def judge(self, action: npt.NDArray[np.float32], *, unstable: bool) -> tuple[float, bool, bool, dict[str, Any]]:
        """Count a control step that has been made: return reward, terminated, truncated and info.

        Raises:
            KindError: If the task's reward is no finite number, or its first judgement is none.
        """
        self._steps += 1
        verdict, reward = NO_REWARD, 0.0
        if not unstable:
            verdict = self._task.judge(self.data, action, self.effort)
            if verdict is not NO_REWARD:
                if self._judged is not self._task:
                    check_judgement(verdict, self._task)
                    self._judged = self._task
                reward = reward_of(verdict, self._task)
        truncated = self._task.steps is not None and self._steps >= self._task.steps
        info = {"is_success": verdict.success, "reward_terms": dict(verdict.reward_terms), "unstable": unstable}
        info[growing.AGE] = self.age_months
        return reward, verdict.terminated or unstable, truncated, info

    def _observe(self) -> Observation:
        """Return what the senses and the task give, as fresh arrays."""
        return {**self._schedule.observe(), **self._task.observe()}
