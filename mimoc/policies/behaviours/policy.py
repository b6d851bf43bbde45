"""The policy that does some behaviours at once: where its episodes begin, its actions, and its metrics."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.policies.behaviours.behaviour import Behaviour, Chance, Subject
from mimoc.policies.control.holding import Rehearsal, Servo, servo
from mimoc.policies.control.infant import DrivenInfant
from mimoc.policies.policy import begin_here, merged_metrics, numbered
from mimoc.runtime.delays import timing_of
from mimoc.runtime.infant import Infant
from mimoc.runtime.sense import FloatArray, IntArray, Observation

NOBODY = -1  # In place of the number of a behaviour, for joints that none moves.
ACTUATIONS = ("torque", "muscle", "position")  # Actuation models of whose commands the torques are known.
CHECKED_EVERY_S = 0.05  # How often a posture is checked for being lost, as in the trials.


class Ensemble:
    """Some behaviours together: the angles that they propose for the n driven hinges of an infant, and the commands.

    A posture of the whole body moves all joints but those that other behaviours move; joints that none moves get no
    commands.
    """

    def __init__(self, subject: Subject, behaviours: Sequence[Behaviour], labels: Sequence[str], actuators: IntArray):
        """Put bound behaviours together; PolicyError if two are postures of the whole body or begin in a posture."""
        self._subject = subject
        self.behaviours = tuple(behaviours)
        self._labels = tuple(labels)
        self._actuators = actuators
        self.whole = self._only([behaviour.is_whole for behaviour in behaviours], "are postures of the whole body")
        first = self._only([behaviour.start is not None for behaviour in behaviours], "say where an episode begins")
        self.start = None if first is None else behaviours[first].start
        """The posture that an episode begins in, if a behaviour says so."""

    def _only(self, which: Sequence[bool], what: str) -> int | None:
        """Return the index of the only behaviour for which a flag is set, or None; PolicyError if there are several."""
        numbers = np.flatnonzero(which)
        if len(numbers) > 1:
            names = " and ".join(f"'{self._labels[number]}'" for number in numbers)
            raise PolicyError(f"{names} both {what}; choose one of them")
        return int(numbers[0]) if len(numbers) else None

    def begin(self, data: mujoco.MjData) -> None:
        """Begin an episode in a state, positions computed; PolicyError if two behaviours move the same joint."""
        for behaviour in self.behaviours:
            behaviour.begin(data)
        infant = self._subject.infant
        self._owners = self._find_owners()
        self._may_touch = frozenset[int]().union(*(behaviour.may_touch for behaviour in self.behaviours))
        gains = servo(infant, data, loose=self._loose())
        is_moved = self._owners != NOBODY
        self.rows: IntArray = np.flatnonzero(is_moved[self._slots]).astype(np.intp)
        gains = Servo(gains.stiffness_nm * is_moved, gains.damping_nms * is_moved)
        timing = timing_of(self._subject.manifest, {})
        self._rehearsal = Rehearsal(infant, gains, self._actuators[self.rows], timing)

    def hold(self, data: mujoco.MjData) -> None:
        """Let actuators that are late hold the pose of a state until their first command acts.

        Limp for the time of their delay, an infant that is put into a posture would slump.
        """
        rehearsal = self._rehearsal
        pose_rad = data.qpos[self._subject.infant.angles]
        is_late = rehearsal.delay_steps > 0
        data.ctrl[self._actuators[self.rows[is_late]]] = rehearsal.hold(data, pose_rad)[is_late]

    @property
    def _slots(self) -> IntArray:
        return self._subject.infant.slots_of(self._actuators)

    def _find_owners(self) -> IntArray:
        """Return the behaviour that moves each driven hinge, shape (n,), or `NOBODY`."""
        owners = np.full(len(self._subject.infant.joints), NOBODY)
        for number, behaviour in enumerate(self.behaviours):
            if number != self.whole:
                taken = owners[behaviour.joints]
                if (taken != NOBODY).any():
                    first = self._labels[taken[taken != NOBODY][0]]
                    second = self._labels[number]
                    joint = self._subject.infant.joint_names[behaviour.joints[np.argmax(taken != NOBODY)]]
                    raise PolicyError(f"'{first}' and '{second}' both move {joint}; choose one of them")
                owners[behaviour.joints] = number
        if self.whole is not None:
            owners[owners == NOBODY] = self.whole
        return owners

    def _loose(self) -> frozenset[int]:
        """Return the hinges that bear nothing; see `Behaviour.loose`."""
        loose = frozenset[int]()
        for number, behaviour in enumerate(self.behaviours):
            by_default = [] if behaviour.is_whole else behaviour.joints
            joints = np.asarray(by_default if behaviour.loose is None else behaviour.loose, np.intp)
            loose |= set(joints[self._owners[joints] == number].tolist())
        return loose

    def proposed(self, ahead: mujoco.MjData, time_s: float, hinges: IntArray | None = None) -> FloatArray:
        """Return the angle that each driven hinge is to go to, shape (n,); its present one if no behaviour moves it.

        Only the behaviours that move at least one of certain *hinges* are asked; None is all hinges.
        """
        angles_rad = ahead.qpos[self._subject.infant.angles].copy()
        asked = range(len(self.behaviours)) if hinges is None else set(self._owners[hinges].tolist())
        for number, behaviour in enumerate(self.behaviours):
            if number in asked:
                is_owned = self._owners[behaviour.joints] == number
                angles_rad[behaviour.joints[is_owned]] = behaviour.targets(ahead, time_s)[is_owned]
        return angles_rad

    def commands(self, data: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the commands of the actuators of `rows`, for a control step that begins in a state."""
        return self._rehearsal(data, lambda ahead, hinges: self.proposed(ahead, time_s, hinges))

    def lost(self, data: mujoco.MjData) -> str:
        """Return why the posture of the whole body is lost; nothing if it is not, or there is none."""
        return "" if self.whole is None else self.behaviours[self.whole].lost(data, self._may_touch)


@dataclass(frozen=True, slots=True)
class NamedBehaviour:
    """A behaviour that is still to be bound to an infant."""

    label: str  # What it is called in errors and metrics.
    bind: Callable[[Subject], Behaviour]


class BehaviourPolicy:
    """Does some behaviours at once, within the infant's own strength.

    An episode begins in the posture of a behaviour that has one, in the infant's place and facing as it does.
    """

    def __init__(self, env: Infant, named: Sequence[NamedBehaviour]):
        """Bind behaviours to an infant; PolicyError if they do not go together, or the infant cannot do one of them."""
        self._env = env
        self._named = tuple(named)
        self._labels = numbered([behaviour.label for behaviour in named])
        self._finished = list[Mapping[str, float]]()
        self._begun_at = np.empty(0)
        self._lost_after_s: float | None = None
        self._seen_s = 0.0
        self._chance = Chance()
        self._bind()

    def begin(self) -> Observation:
        """Begin an episode, in the posture of a behaviour that has one, and return what the infant senses then.

        Raises:
            PolicyError: If held parts or locked joints keep it out of this posture, or two behaviours move one joint.
        """
        env = self._env
        if self._seen_s:
            self._finished.append(self._of_episode())
        if env.model is not self._model:
            self._bind()
        constraints = env.manifest.constraints
        if self._ensemble.start is not None and not (constraints.locks or constraints.welds):
            self._put_into(self._ensemble.start)
        mujoco.mj_fwdPosition(env.model, env.data)
        self._ensemble.begin(env.data)
        self._ensemble.hold(env.data)
        observation = begin_here(env)
        if reason := self._ensemble.lost(env.data):
            label = self._labels[self._ensemble.whole or 0]
            advice = "choose another scene.pose, or hold other parts"
            raise PolicyError(f"'{label}' cannot begin where held parts or locked joints are ({reason}); {advice}")
        self._begun_at = env.data.qpos[~self._is_of_others]
        self._lost_after_s = None
        self._seen_s = 0.0
        return observation

    def _put_into(self, start: mujoco.MjData) -> None:
        """Put the infant into a posture, where it is and facing as it does."""
        infant = self._infant
        model = self._env.model
        data = self._env.data
        is_hinge = infant.is_own[model.jnt_bodyid] & (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE)
        hinges = model.jnt_qposadr[is_hinge]
        data.qpos[hinges] = start.qpos[hinges]
        data.qvel[infant.is_own[model.dof_bodyid]] = 0.0
        leftward = data.xmat[infant.root].reshape(3, 3)[:, 1]  # Horizontal, however the trunk is pitched.
        yaw_rad = np.arctan2(-leftward[0], leftward[1])
        turn = np.array([np.cos(yaw_rad / 2), 0.0, 0.0, np.sin(yaw_rad / 2)])  # The quaternion of this turn about z.
        place = data.qpos[infant.place]  # A view, so that what is written to it below is written to the state.
        posed = start.qpos[infant.place]
        place[2] = posed[2]
        mujoco.mju_mulQuat(place[3:], turn, posed[3:])

    def __call__(self, generator: np.random.Generator, observation: Observation) -> np.ndarray:
        """Return the action, shape (n,); only the times of reactions are drawn from the generator."""
        env = self._env
        self._chance.generator = generator
        if env.steps == 0 and not np.array_equal(env.data.qpos[~self._is_of_others], self._begun_at):
            self.begin()
        elif env.model is not self._model:  # The infant has grown.
            self._bind()
            self._ensemble.begin(env.data)
        # The allowed command nearest to 0, for actuators that nothing drives.
        action = np.clip(0.0, env.actuation.low, env.actuation.high)
        if np.isfinite(env.data.qpos).all():  # If not, the simulation became unstable, and the episode is over.
            time_s = env.steps * self._step_s
            self._watch(time_s)
            action[self._ensemble.rows] = self._ensemble.commands(env.data, time_s)
        return action.astype(np.float32)

    def metrics(self) -> Mapping[str, float]:
        """Return the mean of each metric over the episodes that have it; docs/behaviours.md says what they are."""
        episodes = [*self._finished, *([self._of_episode()] if self._seen_s else [])]
        names = dict.fromkeys(name for episode in episodes for name in episode)
        return {name: float(np.mean([episode[name] for episode in episodes if name in episode])) for name in names}

    def _bind(self) -> None:
        env = self._env
        model = env.model
        actuation = env.manifest.actuation.model
        if actuation not in ACTUATIONS:
            raise PolicyError(f"behaviours need actuation: {' or '.join(ACTUATIONS)}, not '{actuation}'")
        self._model = model
        self._infant = DrivenInfant.of(model, env.manifest)
        joints = np.searchsorted(model.jnt_qposadr, np.arange(model.nq), side="right") - 1
        self._is_of_others = self._infant.is_other[model.jnt_bodyid[joints]]
        subject = Subject(self._infant, env.manifest, self._chance)
        self._step_s = subject.step_s
        bound = [behaviour.bind(subject) for behaviour in self._named]
        self._ensemble = Ensemble(subject, bound, self._labels, env.actuation.actuators)

    def _watch(self, time_s: float) -> None:
        data = self._env.data
        every = max(round(CHECKED_EVERY_S / self._step_s), 1)
        for behaviour in self._ensemble.behaviours:
            behaviour.watch(data, time_s)
        if self._lost_after_s is None and self._env.steps % every == 0 and self._ensemble.lost(data):
            self._lost_after_s = time_s
        self._seen_s = time_s + self._step_s

    def _of_episode(self) -> dict[str, float]:
        ensemble = self._ensemble
        lost_s = self._lost_after_s
        held = dict[str, float]()
        if ensemble.whole is not None:
            held = {"held_s": self._seen_s if lost_s is None else lost_s, "held_share": float(lost_s is None)}
        return held | merged_metrics([behaviour.metrics() for behaviour in ensemble.behaviours], self._labels)
