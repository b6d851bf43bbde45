"""The policy that does some behaviours at once: where its episodes begin, its actions, and its metrics."""

import copy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import reduce
from operator import or_
from typing import Any

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.policies.behaviours.behaviour import Behaviour, Chance, Knowledge, Subject
from mimoc.policies.control.estimate import (
    Estimate,
    Organs,
    Reader,
    SenseNoise,
    lacking,
    outgrown,
    told_of,
)
from mimoc.policies.control.holding import FREQUENCY_RAD_S, EstimatedHolding, Rehearsal, Servo, servo
from mimoc.policies.control.infant import DrivenInfant
from mimoc.policies.policy import begin_here, merged_metrics, numbered
from mimoc.runtime.actuation import Actuation
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

    def __init__(
        self,
        subject: Subject,
        behaviours: Sequence[Behaviour],
        labels: Sequence[str],
        actuation: Actuation,
        estimate: Estimate | None = None,
    ):
        """Put bound behaviours together; PolicyError if two are postures of the whole body or begin in a posture.

        Without an *estimate* of the infant's body, they read the simulation.
        """
        self._subject = subject
        self.estimate = estimate
        self._rest = np.clip(0.0, actuation.low, actuation.high)
        self._control: Rehearsal | EstimatedHolding
        self._settled: tuple[bytes, mujoco.MjData] | None = None  # A posture, and the state into which it settled.
        self.behaviours = tuple(behaviours)
        self._labels = tuple(labels)
        self._actuators = actuation.actuators
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
        gains = servo(infant, data, loose=self._loose(), frequency_rad_s=self._frequencies())
        is_moved = self._owners != NOBODY
        self.rows: IntArray = np.flatnonzero(is_moved[self._slots]).astype(np.intp)
        gains = Servo(gains.stiffness_nm * is_moved, gains.damping_nms * is_moved)
        timing = timing_of(self._subject.manifest, {})
        if self.estimate:
            if not (self._settled and self._settled[0] == data.qpos.tobytes()):
                self._control = EstimatedHolding(infant, gains, self._actuators, self.rows, self.estimate)
        else:
            self._control = Rehearsal(infant, gains, self._actuators[self.rows], timing)

    def hold(self, data: mujoco.MjData, may_settle: bool = False) -> None:
        """Let actuators hold the pose of a state until their first command acts.

        Limp for the time of their delay, an infant that is put into a posture would slump. One that estimates its body
        begins as it has settled, if it *may settle*: nobody lets go of an infant before it sits.
        """
        control = self._control
        if isinstance(control, Rehearsal):
            held = control.hold(data, data.qpos[self._subject.infant.angles])
            is_late = control.delay_steps > 0
            data.ctrl[self._actuators[self.rows[is_late]]] = held[is_late]
            return
        settled = self._settle(data)
        if may_settle and not (self.lost(settled) or self._meets_others(data)):
            self._pose_as(settled, data)
        control.begin(data, settled)

    def go_on(self, former: Estimate, data: mujoco.MjData) -> None:
        """Go on, after `begin`, from the estimate of the same infant at another age."""
        if self.estimate:
            self.estimate.become(former, data, self._settle(data))

    def _settle(self, data: mujoco.MjData) -> mujoco.MjData:
        """Return the state into which the posture of a state settles; the last one again if it is the same posture."""
        assert isinstance(self._control, EstimatedHolding)
        posture = data.qpos.tobytes()
        if self._settled is None or self._settled[0] != posture:
            lying = np.flatnonzero(self._owners == (NOBODY if self.whole is None else self.whole)).astype(np.intp)
            state = self._control.settled(data, data.qpos[self._subject.infant.angles], self._rest, lying)
            self._settled = posture, state
        settled = self._settled[1]
        if not self.lost(settled):
            for behaviour in self.behaviours:
                behaviour.settle(settled)
        return settled

    def _meets_others(self, data: mujoco.MjData) -> bool:
        """Return whether the infant touches another, who would push it out of its posture."""
        infant = self._subject.infant
        pairs = infant.model.geom_bodyid[data.contact.geom].reshape(-1, 2)
        return bool((infant.is_own[pairs].any(axis=1) & infant.is_other[pairs].any(axis=1)).any())

    def _pose_as(self, settled: mujoco.MjData, data: mujoco.MjData) -> None:
        """Put the infant into the pose of another state, at rest, where it is."""
        infant, model = self._subject.infant, self._subject.infant.model
        hinges = model.jnt_qposadr[infant.is_own[model.jnt_bodyid] & (model.jnt_type == mujoco.mjtJoint.mjJNT_HINGE)]
        data.qpos[infant.place][2:] = settled.qpos[infant.place][2:]
        data.qpos[hinges] = settled.qpos[hinges]
        mujoco.mj_forward(model, data)

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

    def _frequencies(self) -> FloatArray:
        """Return the natural frequency of each driven hinge, shape (n,); see `Behaviour.frequency_rad_s`."""
        frequencies = np.full(len(self._subject.infant.joints), FREQUENCY_RAD_S)
        for number, behaviour in enumerate(self.behaviours):
            is_owned = self._owners[behaviour.joints] == number
            own = np.broadcast_to(behaviour.frequency_rad_s, len(behaviour.joints))
            frequencies[behaviour.joints[is_owned]] = own[is_owned]
        if self.estimate and self.whole is not None:
            of_posture = (self._owners == self.whole) & (frequencies == FREQUENCY_RAD_S)
            frequencies[of_posture] = self.behaviours[self.whole].estimated_rad_s
        return frequencies

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
        control = self._control

        def propose(ahead: mujoco.MjData, hinges: IntArray) -> FloatArray:
            return self.proposed(ahead, time_s, hinges)

        return control(data, propose) if isinstance(control, Rehearsal) else control(propose, self._rest)

    def lost(self, data: mujoco.MjData) -> str:
        """Return why the posture of the whole body is lost; nothing if it is not, or there is none."""
        return "" if self.whole is None else self.behaviours[self.whole].lost(data, self._may_touch)


@dataclass(frozen=True, slots=True)
class NamedBehaviour:
    """A behaviour that is still to be bound to an infant."""

    label: str  # What it is called in errors and metrics.
    bind: Callable[[Subject], Behaviour]
    knowledge: Knowledge = field(default_factory=Knowledge)


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
        is_put = self._ensemble.start is not None and not (constraints.locks or constraints.welds)
        if is_put and self._ensemble.start is not None:
            self._put_into(self._ensemble.start)
        mujoco.mj_fwdPosition(env.model, env.data)
        self._ensemble.begin(env.data)
        self._ensemble.hold(env.data, is_put)
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
        """Return the action, shape (n,)."""
        env = self._env
        self._chance.generator = generator
        if env.steps == 0 and not np.array_equal(env.data.qpos[~self._is_of_others], self._begun_at):
            observation = self.begin()
        elif env.model is not self._model:
            self._go_on_grown()
        # The allowed command nearest to 0, for actuators that nothing drives.
        action = np.clip(0.0, env.actuation.low, env.actuation.high)
        if np.isfinite(env.data.qpos).all():  # If not, the simulation became unstable, and the episode is over.
            time_s = env.steps * self._step_s
            if self._ensemble.estimate and self._reader:
                self._ensemble.estimate.see(self._reader(observation), env.data, env.schedule.sent)
            for behaviour in self._ensemble.behaviours:
                behaviour.sense(observation, time_s, generator)
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
        told = self._knowledge.reads_truth
        subject = Subject(self._infant, env.manifest, self._chance, told, not self._reads_truth)
        self._step_s = subject.step_s
        bound = [behaviour.bind(subject) for behaviour in self._named]
        self._reader = None if self._reads_truth else Reader(env)
        self._ensemble = Ensemble(subject, bound, self._labels, env.actuation, self._new_estimate())

    @property
    def _knowledge(self) -> Knowledge:
        return reduce(or_, [behaviour.knowledge for behaviour in self._named])

    @property
    def _reads_truth(self) -> bool:
        return self._knowledge.reads_truth or bool(lacking(self._env.manifest))

    def _new_estimate(self) -> Estimate | None:
        """Return the estimate of the infant's body by its own senses; None if it reads the simulation."""
        if self._reads_truth:
            return None
        env, infant = self._env, self._infant
        timing = timing_of(env.manifest, env.senses)
        organs = Organs.of(infant.model, env.manifest, timing, SenseNoise.of(env))
        lag_weeks = self._knowledge.lag_weeks
        believed = outgrown(infant, env.age_months, lag_weeks) if lag_weeks else None
        return Estimate(infant, env.actuation.actuators, timing, organs, believed)

    def _go_on_grown(self) -> None:
        """Go on in the body of another age, with what the infant took its state to be."""
        former = self._ensemble.estimate
        self._bind()
        self._ensemble.begin(self._env.data)
        if former:
            self._ensemble.go_on(former, self._env.data)

    def notes(self) -> tuple[str, ...]:
        """Return in sentences what the infant's behaviours know that its senses do not tell."""
        estimate = self._ensemble.estimate
        return told_of(self._env.manifest, self._knowledge.reads_truth, estimate.times_lost if estimate else 0)

    @property
    def state(self) -> dict[str, Any]:
        """What the infant takes the state of its body to be, and what its behaviours remember of this episode."""
        estimate = self._ensemble.estimate
        return {
            "estimate": None if estimate is None else estimate.state,
            "behaviours": [copy.deepcopy(vars(one), self._shared()) for one in self._ensemble.behaviours],
            "episode": (self._begun_at.copy(), self._lost_after_s, self._seen_s),
        }

    @state.setter
    def state(self, state: dict[str, Any]) -> None:
        estimate = self._ensemble.estimate
        if estimate:
            estimate.state = state["estimate"]
        for behaviour, remembered in zip(self._ensemble.behaviours, state["behaviours"], strict=True):
            vars(behaviour).update(copy.deepcopy(remembered, self._shared()))
        self._begun_at, self._lost_after_s, self._seen_s = state["episode"]

    def _shared(self) -> dict[int, Any]:
        """Return what copies of behaviours have in common, for `copy.deepcopy`."""
        shared = self._env, self._model, self._infant, self._chance, self._env.manifest
        return {id(item): item for item in shared}

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
