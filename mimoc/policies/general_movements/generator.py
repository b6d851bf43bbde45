"""Spontaneous movement of k infants at once: bursts over muscle synergies, slow and fidgety drives, and arousal.

Everything is an array with a leading axis of k infants, and no branch depends on a value: it runs with NumPy, with
torch and on a device, and row i of k infants is that infant alone, to the bit.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, fields
from typing import Any

import numpy as np

from mimoc.policies.general_movements.joints import LIMBS, POSTURES, Joints
from mimoc.policies.general_movements.law import STYLES, Law, Styles
from mimoc.runtime.array_library import NUMPY
from mimoc.runtime.term import Put
from mimoc.senses.sense import FloatArray

SLOTS = 5
"""Bursts of a limb at one time; one more takes the place of the oldest."""
SMOOTHING_S = 0.25
"""Time constant in which slow drives and movements towards goals set in."""
FIDGET_S = 0.6
"""Time in which fidgety movements lose their rhythm."""
LEFT = np.array([-1.0, 1.0, -1.0, 1.0, 0.0, 0.0])
ARMS = np.array([1.0, 1.0, 0.0, 0.0, 0.0, 0.0])
LEGS = np.array([0.0, 0.0, 1.0, 1.0, 0.0, 0.0])
TRUNK = np.array([0.0, 0.0, 0.0, 0.0, 1.0, 1.0])
TRAITS = tuple(field.name for field in fields(Styles) if field.name not in ("posture", "limbs"))


class GeneralMovements:
    """The spontaneous movement of k infants with the same commands."""

    def __init__(
        self,
        joints: Joints,
        laws: Sequence[Law],
        step_s: float,
        styles: Styles = STYLES,
        xp: Any = NUMPY,
        put: Put = np.asarray,
    ):
        """Prepare the movement of infants.

        Args:
            joints: The joints of all of them.
            laws: The law of each, k.
            step_s: Time between two steps.
            styles: How they differ.
            xp: The array library.
            put: Moves NumPy's arrays into it.
        """
        self._xp, self._put, self._step_s, self._joints, self._styles = xp, put, step_s, joints, styles
        limbs, hinges = len(LIMBS), len(joints.names)
        self.normals = 1 + 5 * limbs + 3 * hinges
        """Standard normal numbers that a step needs of each infant."""
        self.uniforms = 3 * limbs + 3
        """Numbers from 0 to 1 that a step needs of each infant."""
        self.starts = len(TRAITS) + 1 + 2 * limbs + limbs + 4 * hinges
        """Standard normal numbers that the start needs of each infant."""
        self._law = {name: put(np.array([[asdict(law)[name]] for law in laws])) for name in asdict(laws[0])}
        self._flexion, self._distal, self._postures, self._goals = (
            put(array[None]) for array in (joints.flexion, joints.distal, joints.postures, joints.goals)
        )
        self._limb, self._hinge = put(joints.limbs), put(joints.hinges)
        self._signs, self._is_muscle, self._low, self._high = (
            put(array[None]) for array in (joints.signs, joints.is_muscle, joints.low, joints.high)
        )
        self._slots = put(np.arange(SLOTS, dtype=np.float64)[None, :, None])

    def start(self, normal: Any) -> None:
        """Draw the style of each infant, and begin in the midst of its movement.

        Args:
            normal: Standard normal numbers, shape (k, starts).
        """
        xp, law, styles = self._xp, self._law, self._styles
        limbs, hinges = len(LIMBS), len(self._joints.names)
        sizes = (*[1] * len(TRAITS), 1, limbs, limbs, limbs, *[hinges] * 4)
        *traits, self._arousal, self._activity, self._bend, lasting, self._slow, self._fidget, quadrature, posture = (
            _split(normal, sizes)
        )
        z = dict(zip(TRAITS, traits, strict=True))
        arms, legs, trunk, left = (self._put(array[None]) for array in (ARMS, LEGS, TRUNK, LEFT))
        size = law["strength"] * xp.exp(styles.strength * z["strength"])
        arms_over_legs = law["arms"] * xp.exp(styles.arms * z["arms"])
        self._size = size * (arms * arms_over_legs + legs + trunk * law["trunk"])
        self._rate_hz = law["rate_hz"] * xp.exp(styles.rate * z["rate"] + left * styles.side * z["side"])
        self._duration_s = law["duration_s"] * xp.exp(styles.duration * z["duration"])
        self._swell = law["swell"] * xp.exp(styles.swell * z["swell"])
        slow = law["slow"] * xp.exp(styles.slow * z["slow"])
        weight = 1.0 - self._distal + law["distal"] * self._distal
        self._scale = xp.concat([arms + legs + trunk * law["trunk"]], axis=-1)
        self._scale = xp.take(self._scale, self._limb, axis=1) * weight
        self._slow_size, self._weight = slow * self._scale, weight
        self._tone = law["tone"] * xp.exp(styles.tone * z["tone"])
        self._in_phase = arms * law["arms_in_phase"] + legs * law["legs_in_phase"]
        lasting = xp.take(styles.limbs * lasting, self._limb, axis=1) * self._flexion + styles.posture * posture
        self._posture = lasting * self._scale
        for index, name in enumerate(POSTURES):
            self._posture = self._posture + law[name] * self._postures[:, index]
        zeros = 0.0 * self._slow
        self._quadrature, self._slowly, self._goal, self._going = quadrature, self._slow, zeros, zeros
        self._slowly_bend = self._bend
        empty = 0.0 * self._slots + 0.0 * self._activity[:, None, :]
        self._age_s, self._length_s, self._next = empty + 10.0, empty + 1.0, 0.0 * self._activity
        self._pattern = 0.0 * self._slots + zeros[:, None, :]

    def step(self, uniform: Any, normal: Any, arousal: Any = 1.0) -> Any:
        """Return the commands of the next control step, shape (k, n).

        Args:
            uniform: Numbers from 0 to 1, shape (k, uniforms).
            normal: Standard normal numbers, shape (k, normals).
            arousal: How awake the infants are, shape (k, 1), or one number: 0 is not at all, 1 quiet.
        """
        xp, law = self._xp, self._law
        limbs, hinges = len(LIMBS), len(self._joints.names)
        arousing, activity, bend, size, duration, direction, slow, fidget, pattern = _split(
            normal, (1, *[limbs] * 5, *[hinges] * 3)
        )
        begins, goal, chosen, together = _split(uniform, (limbs, limbs, limbs, 3))
        self._arousal = self._drift(self._arousal, arousing, law["swell_s"])
        self._activity = self._drift(self._activity, activity, law["limb_swell_s"])
        self._bend = self._drift(self._bend, bend, law["slow_s"])
        self._slow = self._drift(self._slow, slow, law["slow_s"])
        ease = 1.0 - math.exp(-self._step_s / SMOOTHING_S)
        self._slowly_bend = self._slowly_bend + ease * (self._bend - self._slowly_bend)
        self._slowly = self._slowly + ease * (self._slow - self._slowly)
        self._oscillate(fidget)
        self._begin(begins, together, size, duration, direction, pattern, arousal)
        self._aim(goal, chosen, ease, arousal)
        coherence = law["coherence"]
        slowly = coherence * self._flexion * xp.take(self._slowly_bend, self._limb, axis=1)
        slowly = slowly + xp.sqrt(1.0 - coherence**2) * self._slowly
        level = xp.exp(law["size_swell"] * self._arousal) * arousal
        share = self._posture + self._slow_size * slowly + law["fidget"] * self._scale * level * self._fidget
        share = share + self._bursts() + law["goals"] * self._going
        return self._commands(share, arousal)

    def _drift(self, value: Any, normal: Any, seconds: Any) -> Any:
        """Return an Ornstein-Uhlenbeck process of variance 1 one step later."""
        keep = self._xp.exp(-self._step_s / seconds)
        return keep * value + self._xp.sqrt(1.0 - keep**2) * normal

    def _oscillate(self, normal: Any) -> None:
        """Turn the fidgety drives, two numbers a joint, by a step, and let chance disturb their rhythm."""
        xp, angle = self._xp, 2.0 * math.pi * self._step_s * self._law["fidget_hz"]
        keep = math.exp(-self._step_s / FIDGET_S)
        cos, sin = xp.cos(angle), xp.sin(angle)
        former, quadrature = self._fidget, self._quadrature
        self._fidget = keep * (cos * former - sin * quadrature) + math.sqrt(2.0 * (1.0 - keep**2)) * normal
        self._quadrature = keep * (sin * former + cos * quadrature)

    def _begin(self, begins, together, size, duration, direction, pattern, arousal) -> None:
        """Let bursts begin: in a limb by itself, in both arms or both legs, or in all limbs."""
        xp, law = self._xp, self._law
        swell = self._swell
        common = self._rate_hz * xp.exp(swell * self._arousal - swell**2 / 2) * arousal * self._step_s
        alone = xp.exp(law["limb_swell"] * self._activity - law["limb_swell"] ** 2 / 2)
        alone = common * alone * (1.0 - law["together"] - law["whole"])
        in_arms, in_legs, in_all = together[:, :1], together[:, 1:2], together[:, 2:]
        arms, legs = self._put(ARMS[None] > 0), self._put(LEGS[None] > 0)
        pair = (arms & (in_arms < common * law["together"])) | (legs & (in_legs < common * law["together"]))
        everywhere = in_all < common * law["whole"]
        starts = (begins < alone) | pair | everywhere
        other = xp.take(direction, self._put(np.array([0, 0, 2, 2, 4, 5])), axis=1)
        own = xp.sqrt(1.0 - self._in_phase**2) * direction
        is_left = self._put(LEFT[None] > 0)
        direction = xp.where((pair | everywhere) & is_left, self._in_phase * other + own, direction)
        is_new = starts[:, None, :] & (xp.abs(self._slots - self._next[:, None, :]) < 0.5)
        lengths_s = self._duration_s * xp.exp(law["duration_spread"] * duration)
        sizes = self._size * xp.exp(law["size_spread"] * size + law["size_swell"] * self._arousal) * arousal
        coherence = law["coherence"]
        along = coherence * self._flexion * xp.take(direction, self._limb, axis=1)
        shares = (along + xp.sqrt(1.0 - coherence**2) * pattern) * self._weight
        shares = shares * xp.take(sizes, self._limb, axis=1)
        self._age_s = xp.where(is_new, 0.0, self._age_s + self._step_s)
        self._length_s = xp.where(is_new, lengths_s[:, None, :], self._length_s)
        self._pattern = xp.where(xp.take(is_new, self._limb, axis=2), shares[:, None, :], self._pattern)
        following = xp.where(self._next > SLOTS - 1.5, 0.0, self._next + 1.0)
        self._next = xp.where(starts, following, self._next)

    def _bursts(self) -> Any:
        """Return the sum of all bursts now, shape (k, m)."""
        xp, pi = self._xp, math.pi
        part = self._age_s / self._length_s
        wave = xp.sin(pi * part) ** 2
        first = xp.where(part < 1.0, wave, 0.0)
        second = xp.where((part >= 1.0) & (part < 2.0), wave, 0.0)
        shape = first - self._law["rebound"][:, :, None] * second
        return xp.sum(self._pattern * xp.take(shape, self._limb, axis=2), axis=1)

    def _aim(self, goal: Any, chosen: Any, ease: float, arousal: Any) -> None:
        """Let limbs choose other goals now and then, and go there."""
        xp = self._xp
        leaves = xp.take(goal < self._law["goals_hz"] * arousal * self._step_s, self._limb, axis=1)
        kind = xp.take(chosen, self._limb, axis=1) * (self._goals.shape[1] + 1)
        target = 0.0 * kind
        for index in range(self._goals.shape[1]):
            target = xp.where((kind >= index) & (kind < index + 1), self._goals[:, index], target)
        self._goal = xp.where(leaves, target, self._goal)
        self._going = self._going + ease * (self._goal - self._going)

    def _commands(self, share: Any, arousal: Any) -> Any:
        xp = self._xp
        share = xp.concat([share, 0.0 * share[:, :1]], axis=1)
        command = self._signs * xp.take(share, self._hinge, axis=1) + self._is_muscle * self._tone * arousal
        return xp.minimum(xp.maximum(command, self._low), self._high)


def draw(generators: Sequence[np.random.Generator], uniforms: int, normals: int) -> tuple[FloatArray, FloatArray]:
    """Return random numbers of k infants, each from its own generator, shapes (k, uniforms) and (k, normals)."""
    rows = [(generator.random(uniforms), generator.standard_normal(normals)) for generator in generators]
    return np.stack([row[0] for row in rows]), np.stack([row[1] for row in rows])


def _split(array: Any, sizes: Sequence[int]) -> list[Any]:
    """Return consecutive columns of an array."""
    ends = np.cumsum(sizes).tolist()
    return [array[:, end - size : end] for end, size in zip(ends, sizes, strict=True)]
