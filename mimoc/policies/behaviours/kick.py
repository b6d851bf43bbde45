"""Kicking on the back: hip, knee and ankle of a leg flex together and stretch again, then the leg rests.

In newborns the joints of a leg move in synchrony in phases of about .3 s each, whose duration hardly varies, and the
legs alternate (Thelen & Fisher 1983; Thelen, Ridley-Johnson & Fisher 1983).
"""

from collections.abc import Mapping

import mujoco
import numpy as np

from mimoc.base.errors import check_name
from mimoc.policies.behaviours.behaviour import Behaviour, Option, Subject, read_arguments
from mimoc.policies.control.postures import elevation_deg
from mimoc.runtime.sense import FloatArray
from mimoc.schema.names import SIDES

PITCH_DEG = -90.0
RESTING_DEG = {
    "{side}_hip1": -75.0,
    "{side}_knee": -75.0,
    "{side}_foot1": -20.0,
    "{side}_shoulder_ad_ab": 60.0,
    "{side}_elbow": -60.0,
}
"""The pose on the back, legs half flexed, in which an episode begins; legs return to it (an assumption)."""
SYNERGY: Mapping[str, float] = {"hip1": -1.0, "knee": -1.2, "foot1": 0.6}
"""How far joints turn in a kick, by the excursion of the hip: of the middle of published ranges, hip 30 to 60, knee 40
to 70 and ankle 20 to 40 degrees (an assumption as to one infant)."""
PHASE_S = 0.35
OPTIONS = {"rate_per_min": Option(12.0, 1.0, 60.0), "hip_deg": Option(45.0, 5.0, 90.0)}
"""Kicks of each leg in a minute, of which infants of 0 to 4 months filmed on their backs make 12 (MINI-RGBD), and the
excursion of the hip, for which 30 to 60 degrees have been published."""
MIN_UP_DEG = 30.0  # How far the chest of an infant on its back faces up at least; 0 is lying on the side (a choice).
BOTH, LEGS = "both", ("left_leg", "right_leg")
WORDS = (*SIDES, BOTH)


class Kick(Behaviour):
    """Kicks with one leg or, in turn, with both; all else keeps the pose, until the infant turns off its back."""

    is_whole = True

    def __init__(self, subject: Subject, sides: tuple[str, ...], rate_per_min: float, hip_deg: float):
        infant, self._sides = subject.infant, sides
        self.start = start = infant.placed(PITCH_DEG, RESTING_DEG)
        self.joints = np.arange(len(infant.joints))
        self.loose = subject.moved_by(LEGS)
        self._rest_rad = start.qpos[infant.angles].copy()
        names = infant.joint_names
        self._flexed_rad = np.array([_flexion(name, sides, hip_deg) for name in names])
        self._lag = np.array([0.5 if name.startswith(sides[-1]) and len(sides) > 1 else 0.0 for name in names])
        self._infant, self._period_s = infant, 60.0 / rate_per_min
        self._hips = [infant.angles[infant.joint_names.index(f"{side}_hip1")] for side in sides]

    def begin(self, data: mujoco.MjData) -> None:
        """Begin at rest; see `Behaviour`."""
        self._seen_rad = list[FloatArray]()

    def targets(self, ahead: mujoco.MjData, time_s: float) -> FloatArray:
        """Return the angles of the pose, with legs that kick; see `Behaviour`."""
        since_s = (time_s / self._period_s + self._lag) % 1.0 * self._period_s
        share = np.clip(1.0 - np.abs(since_s / PHASE_S - 1.0), 0.0, 1.0)
        return self._rest_rad + self._flexed_rad * (10 * share**3 - 15 * share**4 + 6 * share**5)

    def lost(self, data: mujoco.MjData, may_touch: frozenset[int]) -> str:
        """Return whether it lies on its back no more; see `Behaviour`."""
        return "" if elevation_deg(data, self._infant.pushed) >= MIN_UP_DEG else "not on its back"

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """Note where the hips are; see `Behaviour`."""
        self._seen_rad.append(data.qpos[self._hips].copy())

    def metrics(self) -> Mapping[str, float]:
        """Return the range that the hip that moved least has moved through; see `Behaviour`."""
        return {"kick_hip_deg": float(np.degrees(np.ptp(self._seen_rad, axis=0).min()))} if self._seen_rad else {}


def _flexion(name: str, sides: tuple[str, ...], hip_deg: float) -> float:
    side, _, joint = name.partition("_")
    return float(np.radians(hip_deg * SYNERGY.get(joint, 0.0))) if side in sides else 0.0


def bind(subject: Subject, text: str = "") -> Kick:
    """Return the behaviour that kicks with a leg, or with both; raise a PolicyError if the infant lacks the leg."""
    given = read_arguments("kick", text, OPTIONS, most_words=1)
    side = given.words[0] if given.words else BOTH
    check_name("leg that can kick", side, WORDS)
    sides = SIDES if side == BOTH else (side,)
    subject.require("kick", *(f"{one}_upper_leg" for one in sides))
    return Kick(subject, sides, **given.numbers)
