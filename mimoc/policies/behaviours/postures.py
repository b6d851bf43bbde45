"""Behaviours that keep a posture of the whole body: that of the start, or one of the trials of milestones."""

from collections.abc import Callable

import mujoco
import numpy as np

from mimoc.policies.behaviours.behaviour import Behaviour, Option, Subject, read_arguments
from mimoc.policies.control.postures import (
    FEET,
    MAX_TILT_DEG,
    SEAT,
    SUPPORTS,
    drooped,
    fallen,
    kneel,
    on_forearms,
    seat,
    slumped,
    stance,
)
from mimoc.runtime.sense import FloatArray
from mimoc.schema.names import SIDES

Lost = Callable[[mujoco.MjData, frozenset[int]], str]
"""`lost(data, may_touch)` returns why a posture is lost in a state, empty if it is not; the bodies in *may_touch* are
those that other behaviours may bring to the floor."""


class Posture(Behaviour):
    """Keeps all joints where they are in a posture."""

    is_whole = True

    def __init__(self, subject: Subject, start: mujoco.MjData, lost: Lost):
        self.joints = np.arange(len(subject.infant.joints))
        self.start = start
        self._lost = lost
        self._target_rad = start.qpos[subject.infant.angles]

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles of the posture; see `Behaviour`."""
        return self._target_rad

    def lost(self, data: mujoco.MjData, may_touch: frozenset[int]) -> str:
        """Return why it is lost; see `Behaviour`."""
        return self._lost(data, may_touch)


SIT_OPTIONS = {"knees_deg": Option(-60.0, -90.0, 0.0), "lean": Option(0.3, 0.1, 0.6)}
"""Angle of the knees, and where the centre of mass stands: 0 over the seat, 1 over the heels. The defaults are the
posture in which infants sit youngest."""


def bind_sit(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that sits as in the trial `sit`."""
    infant = subject.infant
    numbers = read_arguments("sit", text, SIT_OPTIONS).numbers
    subject.require("sit", *SEAT, *FEET)
    hip, *thighs = SEAT
    forbidden = infant.parts_without(thighs) - {infant.body(hip)}
    start = seat(infant, numbers["knees_deg"], numbers["lean"])
    return Posture(subject, start, lambda data, others: slumped(infant, data, forbidden - others))


def bind_prone(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that lies on the forearms with the head up, as in the trial `prone_head`."""
    infant = subject.infant
    read_arguments("prone", text, {})
    subject.require("prone", "head", *(f"{side}_{part}" for side in SIDES for part in ("lower_arm", "upper_leg")))
    return Posture(subject, on_forearms(infant), lambda data, others: drooped(infant, data))


KNEELING_OPTIONS = {"elbows_deg": Option(-30.0, -90.0, 0.0), "thighs_deg": Option(20.0, -20.0, 40.0)}
"""Angle of the elbows and forward slant of the thighs."""


def bind_hands_and_knees(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that keeps on hands and knees as in the trial `hands_and_knees`."""
    infant = subject.infant
    numbers = read_arguments("hands_and_knees", text, KNEELING_OPTIONS).numbers
    shanks = [part.replace("upper", "lower") for part in SUPPORTS if part.endswith("_upper_leg")]
    subject.require("hands_and_knees", *SUPPORTS, *shanks)
    forbidden = infant.parts_without(SUPPORTS)
    start = kneel(infant, numbers["elbows_deg"], numbers["thighs_deg"])
    return Posture(subject, start, lambda data, others: infant.touching(data, forbidden - others))


STAND_OPTIONS = {"knees_deg": Option(0.0, -90.0, 0.0), "lean": Option(0.3, 0.0, 1.0)}
"""Angle of the knees, and where the centre of mass stands: 0 over the ankles, 1 over the toes."""


def bind_stand(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that stands as in the trial `stand`."""
    infant = subject.infant
    numbers = read_arguments("stand", text, STAND_OPTIONS).numbers
    subject.require("stand", *FEET, *(foot.replace("foot", "toes") for foot in FEET))
    forbidden = infant.parts_without(FEET)
    start = stance(infant, numbers["knees_deg"], numbers["lean"])
    return Posture(subject, start, lambda data, others: fallen(infant, data, forbidden - others))


class Hold(Behaviour):
    """Keeps all joints where they are when an episode begins; it is lost when the trunk has turned by 45 degrees."""

    is_whole = True

    def __init__(self, subject: Subject):
        self._infant = subject.infant
        self.joints = np.arange(len(self._infant.joints))

    def begin(self, data: mujoco.MjData) -> None:
        """Take note of the pose; see `Behaviour`."""
        self._target_rad = data.qpos[self._infant.angles].copy()
        self._trunk = data.xmat[self._infant.pushed].reshape(3, 3).copy()

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles at the start of the episode; see `Behaviour`."""
        return self._target_rad

    def lost(self, data: mujoco.MjData, may_touch: frozenset[int]) -> str:
        """Return whether the trunk has turned; see `Behaviour`."""
        trunk = data.xmat[self._infant.pushed].reshape(3, 3)
        cosine = (np.trace(self._trunk.T @ trunk) - 1.0) / 2.0  # The trace of a turn by an angle a is 1 + 2 cos(a).
        return "trunk turned" if cosine < np.cos(np.radians(MAX_TILT_DEG)) else ""


def bind_hold(subject: Subject, text: str = "") -> Hold:
    """Return the behaviour that keeps the pose of the start."""
    read_arguments("hold", text, {})
    return Hold(subject)
