"""Behaviours of one infant together: which joints each moves, and the commands of the one controller of all."""

from collections.abc import Sequence

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.policies.behaviours.behaviour import Behaviour, Subject
from mimoc.policies.control.holding.controller import Servo, servo
from mimoc.policies.control.holding.rehearsal import Rehearsal
from mimoc.runtime.delays.timing import timing_of
from mimoc.runtime.sense import FloatArray, IntArray

NOBODY = -1


class Ensemble:
    """What some behaviours propose for the n driven hinges of an infant, and the commands that go there.

    A posture of the whole body moves all joints but those that other behaviours move; joints that none moves get no
    commands.
    """

    def __init__(self, subject: Subject, behaviours: Sequence[Behaviour], labels: Sequence[str], actuators: IntArray):
        """Put bound behaviours together; PolicyError if two are postures of the whole body or begin in a posture."""
        self._subject, self.behaviours, self._labels = subject, tuple(behaviours), tuple(labels)
        self._actuators = actuators
        self.whole = self._only([item.is_whole for item in behaviours], "are postures of the whole body")
        first = self._only([item.start is not None for item in behaviours], "say where an episode begins")
        self.start = None if first is None else behaviours[first].start
        """The posture that an episode begins in, if a behaviour says so."""

    def _only(self, which: Sequence[bool], what: str) -> int | None:
        """Return which one behaviour something is true of, None if of none; raise a PolicyError if of several."""
        numbers = np.flatnonzero(which)
        if len(numbers) > 1:
            names = " and ".join(f"'{self._labels[number]}'" for number in numbers)
            raise PolicyError(f"{names} both {what}; choose one of them")
        return int(numbers[0]) if len(numbers) else None

    def begin(self, data: mujoco.MjData) -> None:
        """Begin an episode in a state, positions computed; PolicyError if two behaviours move the same joint."""
        for behaviour in self.behaviours:
            behaviour.begin(data)
        infant, self._owners = self._subject.infant, self._find_owners()
        self._may_touch = frozenset[int]().union(*(item.may_touch for item in self.behaviours))
        gains, is_moved = servo(infant, data, loose=self._loose()), self._owners != NOBODY
        self.rows: IntArray = np.flatnonzero(is_moved[self._slots]).astype(np.intp)
        gains = Servo(gains.stiffness_nm * is_moved, gains.damping_nms * is_moved)
        timing = timing_of(self._subject.manifest, {})
        self._rehearsal = Rehearsal(infant, gains, self._actuators[self.rows], timing)

    def hold(self, data: mujoco.MjData) -> None:
        """Let actuators that are late hold the pose of a state until their first command acts.

        Limp for the time of their delay, an infant that is put into a posture would slump.
        """
        rehearsal, pose_rad = self._rehearsal, data.qpos[self._subject.infant.angles]
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
                    one, other = self._labels[taken[taken != NOBODY][0]], self._labels[number]
                    joint = self._subject.infant.joint_names[behaviour.joints[np.argmax(taken != NOBODY)]]
                    raise PolicyError(f"'{one}' and '{other}' both move {joint}; choose one of them")
                owners[behaviour.joints] = number
        if self.whole is not None:
            owners[owners == NOBODY] = self.whole
        return owners

    def _loose(self) -> frozenset[int]:
        loose = frozenset[int]()
        for number, behaviour in enumerate(self.behaviours):
            usual = [] if behaviour.is_whole else behaviour.joints
            joints = np.asarray(usual if behaviour.loose is None else behaviour.loose, np.intp)
            loose |= set(joints[self._owners[joints] == number].tolist())
        return loose

    def proposed(self, ahead: mujoco.MjData, time_s: float, hinges: IntArray | None = None) -> FloatArray:
        """Return the angle that each driven hinge is to go to, shape (n,); that it has, of those that none moves.

        Only the behaviours that move some of certain *hinges* are asked; None is all.
        """
        angles_rad = ahead.qpos[self._subject.infant.angles].copy()
        asked = range(len(self.behaviours)) if hinges is None else set(self._owners[hinges].tolist())
        for number, behaviour in enumerate(self.behaviours):
            if number in asked:
                is_its = self._owners[behaviour.joints] == number
                angles_rad[behaviour.joints[is_its]] = behaviour.targets(ahead, time_s)[is_its]
        return angles_rad

    def commands(self, data: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the commands of the actuators of `rows`, for a control step that begins in a state."""
        return self._rehearsal(data, lambda ahead, hinges: self.proposed(ahead, time_s, hinges))

    def lost(self, data: mujoco.MjData) -> str:
        """Return why the posture of the whole body is lost; nothing if it is not, or there is none."""
        return "" if self.whole is None else self.behaviours[self.whole].lost(data, self._may_touch)
