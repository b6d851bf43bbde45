"""Inverse dynamics: torques that let an infant do several things at once, the most important first."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, Protocol

import gymnasium
import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.actuation.binding import Actuation
from mimoc.control.antagonists import Antagonists
from mimoc.control.dynamics import Dynamics, dynamics
from mimoc.control.frames import Motion, find_frame
from mimoc.control.joints import Joints, find_joints
from mimoc.control.motors import Motors
from mimoc.control.objectives import Objective
from mimoc.control.posture import Posture
from mimoc.control.priorities import Wish, joined, size_of
from mimoc.control.stopping import HELD, Turning, fulfil_within
from mimoc.control.supports import Supports
from mimoc.errors import ControlError, UnknownNameError
from mimoc.runtime.env import STATE, InfantEnv
from mimoc.senses.sense import FloatArray, IntArray
from mimoc.units import ms_to_s

Tasks = Sequence[Objective | Posture | Sequence[Objective]]
"""The most important first; those in a sequence of their own share one priority."""


class Drive(Protocol):
    """What moves n joints."""

    @property
    def strength_nm(self) -> FloatArray:
        """Largest torque of each joint, shape (n,)."""
        ...

    def rest(self, model: mujoco.MjModel, data: mujoco.MjData) -> FloatArray:
        """Let the joints rest as far as `data.qfrc_actuator`; return what they could add, shape (n, 2), [N m]."""
        ...

    def command(self, torques_nm: FloatArray) -> FloatArray:
        """Return the action, shape (nu,), that adds some torques, shape (n,)."""
        ...


DRIVES: Mapping[str, Callable[[Actuation, IntArray, mujoco.MjModel, float], Drive]] = {
    "torque": Motors,
    "muscle": Antagonists,
}
"""By actuation model. Servos are none of them: they take angles, and no command says how strong they are to be."""


class InverseDynamics:
    """A controller: each call returns the action that its tasks want of the infant as it is now.

    What a task does never disturbs those before it, and what all of them leave free goes to the posture. Joints stop
    before the ends of their ranges, and no torque is larger than the infant's own. It only looks at the environment,
    which can be reset, put into a state and given another scene as it likes.
    """

    def __init__(
        self, env: gymnasium.Env, tasks: Tasks = (), joints: Sequence[str] | None = None, loose: Sequence[str] = ()
    ):
        """Bind tasks to an infant.

        Args:
            env: Its environment, wrapped or not, with motors or muscles.
            tasks: `Reach`, `Align`, `LookAt`, or the `Posture` of some joints, the most important first; those in a
                list or tuple share one priority. A `Posture` of all joints is last, and added if there is none.
            joints: Those that may move; all others rest. None is all that have actuators.
            loose: Bodies that bear nothing though they touch the ground, such as the feet of who sits.

        Raises:
            ControlError: If this is no infant's environment, it has servos, or something comes after the posture.
            UnknownNameError: If there is no such site, camera, body or joint.
        """
        self._env = _infant(env)
        self._levels, self._posture = _in_order(tasks)
        self._chosen = None if joints is None else tuple(dict.fromkeys([joints] if isinstance(joints, str) else joints))
        self._loose = tuple(loose)
        self._bind()

    @property
    def joints(self) -> tuple[str, ...]:
        """The joints that it moves."""
        return self._joints.names

    def __call__(self) -> npt.NDArray[np.float32]:
        """Return the action for the infant as it is now, one number for each actuator."""
        self._look()
        limits_nm = self._drive.rest(self._model, self._data)
        if not np.isfinite(self._state).all():  # It broke down; the episode is over.
            return self._drive.command(np.zeros(len(limits_nm))).astype(np.float32)
        now = dynamics(self._model, self._data, self._joints.speeds, self._supports.jacobian(self._data))
        torques_nm = self._drive.strength_nm * self._shares(now)
        return self._drive.command(np.clip(torques_nm, limits_nm[:, 0], limits_nm[:, 1])).astype(np.float32)

    def errors(self) -> tuple[float, ...]:
        """Return how far each task is from its target now, [m] or [rad], in their order; postures left out."""
        self._look()
        return tuple(task.error(self._motion(task)) for task in self._frames)

    def _bind(self) -> None:
        """Find everything that is named, once for each scene."""
        env, model = self._env, self._env.model
        self._model, self._data = model, mujoco.MjData(model)
        self._state = np.empty(mujoco.mj_stateSize(model, STATE))
        self._joints = _find_allowed(self._chosen, env.actuation, model)
        step_s = ms_to_s(env.manifest.step_ms)
        self._drive = DRIVES[env.manifest.actuation.model](env.actuation, self._joints.indices, model, step_s)
        self._present_rad = env.data.qpos[self._joints.angles]
        postures = [level for level in (*self._levels, self._posture) if isinstance(level, Posture)]
        tasks = [task for level in self._levels if not isinstance(level, Posture) for task in level]
        self._frames = {task: find_frame(task.site, model) for task in tasks}
        self._members = {posture: posture.members(self.joints) for posture in postures}
        root = model.body(env.manifest.root_body).id
        loose = [find_frame(name, model).body for name in self._loose]
        self._supports = Supports(model, root, [frame.body for frame in self._frames.values()], loose)

    def _look(self) -> None:
        """Bring the controller's own copy of the world up to date."""
        if self._env.model is not self._model:
            self._bind()
        mujoco.mj_getState(self._model, self._env.data, self._state, STATE)
        mujoco.mj_setState(self._model, self._data, self._state, STATE)
        mujoco.mj_forward(self._model, self._data)

    def _motion(self, task: Objective) -> Motion:
        return self._frames[task].motion(self._model, self._data)

    def _shares(self, now: Dynamics) -> FloatArray:
        """Return which share of its strength each joint is to use, shape (n,), however large that comes out."""
        turning, wanted = self._turning(now), self._wanted(now)
        wishes = [
            self._hold(level, turning) if isinstance(level, Posture) else joined([wanted[task] for task in level])
            for level in self._levels
        ]
        least, largest = self._joints.bounds(self._data)
        return fulfil_within(turning, least, largest, wishes, self._hold(self._posture, turning))

    def _turning(self, now: Dynamics) -> Turning:
        """Return how the joints themselves move."""
        strength_nm = self._drive.strength_nm
        response, drift = now.joint_response()
        return Turning(response * strength_nm, drift, now.unheld_response() * strength_nm)

    def _hold(self, posture: Posture, turning: Turning) -> Wish:
        """Return what a posture wants of the torques."""
        members = self._members[posture]
        errors_rad = posture.targets_rad(self.joints, self._present_rad) - self._data.qpos[self._joints.angles]
        wanted = posture.gains.accelerations(errors_rad, self._data.qvel[self._joints.speeds])
        return turning.wish(members, wanted[members])

    def _wanted(self, now: Dynamics) -> dict[Objective, Wish]:
        """Return what each task wants of the torques; nothing, if the world holds what it is about."""
        motions = {task: self._motion(task) for task in self._frames}
        demands = {task: task.demand(motion) for task, motion in motions.items()}
        if not demands:
            return {}
        jacobians = [demand.directions @ motions[task].jacobian for task, demand in demands.items()]
        response, unheld, drift = now.response(np.concatenate(jacobians), self._drive.strength_nm)
        wishes, first = {}, 0
        for task, demand in demands.items():
            rows = slice(first, first := first + len(demand.accelerations))
            wanted = demand.accelerations - demand.directions @ motions[task].drift - drift[rows]
            is_held = size_of(response[rows]) <= HELD * size_of(unheld[rows])
            wishes[task] = Wish(response[rows] * (not is_held), wanted)
        return wishes


def _infant(env: gymnasium.Env) -> InfantEnv:
    """Return the environment of the infant itself.

    Raises:
        ControlError: If it is none, or has servos.
    """
    infant: Any = getattr(env, "unwrapped", env)
    if not isinstance(infant, InfantEnv):
        raise ControlError(f"{type(infant).__name__} is not an infant's environment; make one with mimoc.make(bundle)")
    model = infant.manifest.actuation.model
    if model not in DRIVES:
        others = " or ".join(f"{{model: {other}}}" for other in DRIVES)
        raise ControlError(
            f"inverse dynamics gives torques, and actuation model '{model}' takes angles instead and has no strength "
            f"of its own; build the infant with actuation: {others}"
        )
    return infant


def _in_order(tasks: Tasks) -> tuple[list[tuple[Objective, ...] | Posture], Posture]:
    """Return the tasks by priority, then the posture.

    Raises:
        ControlError: If that is not the last of them, or the posture of some joints shares its priority.
    """
    if not isinstance(tasks, Sequence):
        raise ControlError("tasks come as a list, the most important first; write [task] for one")
    levels: list[Any] = [tuple(task) if isinstance(task, (list, tuple)) else task for task in tasks]
    levels = [level if isinstance(level, (tuple, Posture)) else (level,) for level in levels if level != ()]
    posture = levels.pop() if levels and _is_whole(levels[-1]) else Posture()
    if any(map(_is_whole, levels)):
        raise ControlError("a Posture of all joints leaves nothing free; make it the last task")
    if any(isinstance(task, Posture) for level in levels if isinstance(level, tuple) for task in level):
        raise ControlError("a Posture shares its priority with nothing; take it out of the list that it is in")
    return levels, posture


def _is_whole(level: object) -> bool:
    """Return whether this is a posture of all joints."""
    return isinstance(level, Posture) and level.joints is None


def _find_allowed(chosen: Sequence[str] | None, actuation: Actuation, model: mujoco.MjModel) -> Joints:
    """Return the joints that may move, of those that actuators move; each once.

    Raises:
        UnknownNameError: If one is not moved by any.
    """
    moved = list(dict.fromkeys(model.joint(joint).name for joint in model.actuator_trnid[actuation.actuators, 0]))
    for name in chosen or ():
        if name not in moved:
            raise UnknownNameError("joint with an actuator", name, moved)
    return find_joints(moved if chosen is None else chosen, model)
