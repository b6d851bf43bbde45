"""Behaviours that keep a posture of the whole body: that of the start, or one of the trials of milestones."""

from collections.abc import Callable, Mapping

import mujoco
import numpy as np

from mimoc.policies.behaviours.behaviour import Arguments, Behaviour, Option, Subject, read_arguments
from mimoc.policies.behaviours.small_movements import Moving, SmallMovements
from mimoc.policies.control.balance import Balance
from mimoc.policies.control.holding import ESTIMATED_RAD_S, FREQUENCY_RAD_S
from mimoc.policies.control.infant import DrivenInfant
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
from mimoc.runtime.sense import FloatArray, Observation
from mimoc.schema.names import SIDES

Lost = Callable[[mujoco.MjData, frozenset[int]], str]
"""`lost(data, may_touch)` returns why a posture is lost in a state, empty if it is not; the bodies in *may_touch* are
those that other behaviours may bring to the floor."""
STILL = "still"  # The word of a posture by which nothing of it moves.

FLAGS = (STILL,)
ARMS = (
    "left_arm",
    "right_arm",
    "left_hand",
    "right_hand",
)  # Groups of muscles that bear nothing of an infant that sits or stands.


def _unless_still(given: Arguments, moving: Moving) -> Moving | None:
    return None if STILL in given.flags else moving


class Posture(Behaviour):
    """Keeps all joints where they are in a posture, but for small movements of those that bear nothing."""

    is_whole = True

    def __init__(
        self,
        subject: Subject,
        start: mujoco.MjData,
        lost: Lost,
        moving: Moving | None = None,
        balanced: bool = False,
        free: tuple[str, ...] = (),
        on_feet: bool = False,
    ):
        """Keep the posture of *start*; nothing moves in it unless *moving* says so.

        Muscles of the groups *free* bear nothing in it: an infant that estimates the state of its body holds these
        limbs no more stiffly than their own inertia needs.

        An infant that is *balanced* keeps the tilt of its trunk rather than the angles of its spine, if it
        estimates the state of its body; *on_feet* its ankles balance it as well, and its servo is as stiff as that of
        one who knows all: a soft one tips over.
        """
        self.joints = np.arange(len(subject.infant.joints))
        self.start = start
        self._lost = lost
        self._posture_rad = start.qpos[subject.infant.angles]
        self._movements = SmallMovements(subject, moving) if moving else None
        self.loose = subject.moved_by(free) if subject.estimates else None
        self._balance = Balance(subject.infant, start, on_feet) if balanced and subject.estimates else None
        self.estimated_rad_s = FREQUENCY_RAD_S if on_feet else ESTIMATED_RAD_S
        low_rad, high_rad = subject.infant.model.jnt_range[subject.infant.joints].T
        self._low_rad, self._high_rad = np.minimum(low_rad, self._posture_rad), np.maximum(high_rad, self._posture_rad)

    def begin(self, data: mujoco.MjData) -> None:
        """Begin an episode in the posture; see `Behaviour`."""
        if self._movements:
            self._movements.begin()

    def settle(self, state: mujoco.MjData) -> None:
        """Take note of how the trunk stands; see `Behaviour`."""
        if self._balance:
            self._balance.keep(state)

    def sense(self, observation: Observation, time_s: float, generator: np.random.Generator) -> None:
        """Go on moving; see `Behaviour`."""
        if self._movements:
            self._movements.advance(generator)

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles of the posture, in range, with what movements add to them; see `Behaviour`."""
        if not (self._movements or self._balance):
            return self._posture_rad
        moved_rad = self._posture_rad.copy()
        if self._movements:
            moved_rad += self._movements.offsets_rad
        if self._balance:
            moved_rad += self._balance(ahead)
        return np.minimum(np.maximum(moved_rad, self._low_rad), self._high_rad)

    def lost(self, data: mujoco.MjData, may_touch: frozenset[int]) -> str:
        """Return why it is lost; see `Behaviour`."""
        return self._lost(data, may_touch)


IN_SIT = Moving({"arm": 1.0, "hand": 1.0, "foot": 1.0, "leg": 0.3, "head": 1.0, "trunk": 1.0}, (6.0, 9.0))
"""Ages here and below: half of infants keep the posture at the first, and those who do have done so for three months at
the second."""
LAP_MONTHS, FREE_MONTHS = 6.0, 10.0
"""Ages until which hands rest on the thighs, and from which on they are free in front of the body: infants who have
just learned to sit without their hands on the floor do not use them yet, and older ones play. A choice, angles too."""
LAP_DEG = {
    "shoulder_horizontal": 10.0,
    "shoulder_ad_ab": 5.0,
    "shoulder_rotation": 20.0,
    "elbow": -60.0,
    "fingers": -30.0,
}
FREE_DEG = {"shoulder_horizontal": 30.0, "shoulder_ad_ab": 15.0, "elbow": -85.0, "fingers": -30.0}


def _age_months(subject: Subject) -> float:
    return subject.manifest.child.corrected_age_months


def _between(share: float, first: Mapping[str, float], second: Mapping[str, float]) -> dict[str, float]:
    """Return angles on the way from the first to the second, of both sides, by names as for `DrivenInfant.placed`."""
    names = {**first, **second}
    return {f"{{side}}_{name}": (1.0 - share) * first.get(name, 0.0) + share * second.get(name, 0.0) for name in names}


SIT_OPTIONS = {"knees_deg": Option(-60.0, -90.0, 0.0), "lean": Option(0.3, 0.1, 0.6)}
"""Angle of the knees, and where the centre of mass stands: 0 over the seat, 1 over the heels. The defaults are the
posture in which infants sit youngest."""


def bind_sit(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that sits as in the trial `sit`, with arms as at its age."""
    infant = subject.infant
    given = read_arguments("sit", text, SIT_OPTIONS, flags=FLAGS)
    subject.require("sit", *SEAT, *FEET)
    hip, *thighs = SEAT
    forbidden = infant.parts_without(thighs) - {infant.body(hip)}
    free = float(np.interp(_age_months(subject), (LAP_MONTHS, FREE_MONTHS), (0.0, 1.0)))
    arms_deg = _between(free, LAP_DEG, FREE_DEG)
    start = seat(infant, given.numbers["knees_deg"], given.numbers["lean"], arms_deg)
    return Posture(
        subject,
        start,
        lambda data, others: slumped(infant, data, forbidden - others),
        _unless_still(given, IN_SIT),
        True,
        ARMS,
    )


IN_PRONE = Moving({"hand": 0.3, "foot": 1.0, "leg": 1.0, "head": 0.6}, (3.0, 6.0))


def bind_prone(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that lies on the forearms with the head up, as in the trial `prone_head`."""
    infant = subject.infant
    given = read_arguments("prone", text, {}, flags=FLAGS)
    subject.require("prone", "head", *(f"{side}_{part}" for side in SIDES for part in ("lower_arm", "upper_leg")))
    return Posture(
        subject, on_forearms(infant), lambda data, others: drooped(infant, data), _unless_still(given, IN_PRONE)
    )


KNEELING_OPTIONS = {"elbows_deg": Option(-30.0, -90.0, 0.0), "thighs_deg": Option(20.0, -20.0, 40.0)}
"""Angle of the elbows and forward slant of the thighs."""


IN_KNEELING = Moving({"foot": 1.0, "head": 0.6}, (7.0, 10.0))


def bind_hands_and_knees(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that keeps on hands and knees as in the trial `hands_and_knees`."""
    infant = subject.infant
    given = read_arguments("hands_and_knees", text, KNEELING_OPTIONS, flags=FLAGS)
    shanks = [part.replace("upper", "lower") for part in SUPPORTS if part.endswith("_upper_leg")]
    subject.require("hands_and_knees", *SUPPORTS, *shanks)
    forbidden = infant.parts_without(SUPPORTS)
    start = kneel(infant, given.numbers["elbows_deg"], given.numbers["thighs_deg"])
    return Posture(
        subject,
        start,
        lambda data, others: infant.touching(data, forbidden - others),
        _unless_still(given, IN_KNEELING),
    )


IN_STAND = Moving({"arm": 1.0, "hand": 1.0, "head": 1.0, "trunk": 0.3}, (11.0, 14.0))
GUARD_MONTHS = 13.0, 16.0
"""Ages until which arms are in high guard, and from which on they hang: infants walk alone at 12.1 months on average
(WHO 2006), and lower their arms in the first months of walking (Ledebt 2000, from memory); a choice within that."""
GUARD_DEG = {
    "shoulder_horizontal": 20.0,
    "shoulder_ad_ab": 62.0,
    "shoulder_rotation": -65.0,
    "elbow": -105.0,
    "fingers": -40.0,
}
HANGING_DEG = {"elbow": -15.0, "fingers": -30.0}
APART_MONTHS, APART_HIP_WIDTHS = (12.0, 18.0), (1.5, 1.0)
"""How far the feet are apart, in distances of the joints of the hips: 1.5 until infants walk, and less half a year
later, in which the width of steps halves (Bril & Brenière 1992)."""


def _legs_apart(infant: DrivenInfant, hip_widths: float) -> dict[str, float]:
    """Return angles at which straight legs have feet so far apart, soles flat, as for `DrivenInfant.placed`."""
    data = infant.placed(0.0, {})
    hips_m, feet_m = ([data.xpos[infant.body(f"{side}_{part}")] for side in SIDES] for part in ("upper_leg", "foot"))
    width_m = float(np.linalg.norm(hips_m[0] - hips_m[1]))
    leg_m = float(np.linalg.norm(hips_m[0] - feet_m[0]))
    outwards_deg = float(np.degrees(np.arcsin(min((hip_widths - 1.0) * width_m / (2.0 * leg_m), 0.5))))
    return {"{side}_hip2": -outwards_deg, "{side}_foot2": outwards_deg}


STAND_OPTIONS = {"knees_deg": Option(0.0, -90.0, 0.0), "lean": Option(0.3, 0.0, 1.0)}
"""Angle of the knees, and where the centre of mass stands: 0 over the ankles, 1 over the toes."""
ESTIMATED_LEAN = Option(0.18, 0.0, 1.0)
"""The same lean of an infant that estimates the state of its body: with more, ankles of 11 months have no force left to
balance. Fitted to standing at 11 to 15 months."""


def bind_stand(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that stands as in the trial `stand`, with arms and feet as at its age."""
    infant = subject.infant
    options = {**STAND_OPTIONS, "lean": ESTIMATED_LEAN} if subject.estimates else STAND_OPTIONS
    given = read_arguments("stand", text, options, flags=FLAGS)
    subject.require("stand", *FEET, *(foot.replace("foot", "toes") for foot in FEET))
    forbidden = infant.parts_without(FEET)
    age_months = _age_months(subject)
    hanging = float(np.interp(age_months, GUARD_MONTHS, (0.0, 1.0)))
    apart = float(np.interp(age_months, APART_MONTHS, APART_HIP_WIDTHS))
    limbs_deg = _between(hanging, GUARD_DEG, HANGING_DEG) | _legs_apart(infant, apart)
    start = stance(infant, given.numbers["knees_deg"], given.numbers["lean"], limbs_deg)
    return Posture(
        subject,
        start,
        lambda data, others: fallen(infant, data, forbidden - others),
        _unless_still(given, IN_STAND),
        balanced=True,
        free=ARMS,
        on_feet=True,
    )


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
