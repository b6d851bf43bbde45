"""Spontaneous movement of k infants at once: bursts over muscle synergies, slow and fidgety drives, and arousal.

Everything is an array with a leading axis of k infants, and no branch depends on a value: it runs with NumPy, with
torch and on a device, and row i of k infants is that infant alone, to the bit.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from mimoc.base.units import ms_to_s
from mimoc.policies.felt_hinges import SENSE, FeltHinges, Turned
from mimoc.policies.movement_law import (
    ARMS,
    IS_LEFT,
    LEGS,
    LIMBS,
    MIDLINE_PER_RAD,
    MIDLINE_PER_RAD_S,
    OTHER_SIDE,
    POSTURES,
    STYLES,
    TRAITS,
    TRUNK,
    Joints,
    Law,
    Styles,
    joints_of,
    law_at,
)
from mimoc.policies.policy import Batch
from mimoc.runtime.sense import FloatArray
from mimoc.runtime.term import Put
from mimoc.runtime.worlds import NUMPY

SLOTS = 5  # Bursts of a limb at one time; one more takes the place of the oldest.


class Bursts:
    """The bursts that are under way.

    A burst asks hinge j for the share p_j s(t) of its strength, where

        s(t) = sin²(π t / T)        for 0 <= t < T
             = -r sin²(π t / T)     for T <= t < 2 T
             = 0                    afterwards

    t is the time since it began, T its duration, and r its rebound. The slots of a limb are taken in turn:

        slot     0      1      2      3      4
        t / T   2.3    0.2     -      -     3.1      the next burst of this limb goes into slot 2
    """

    def __init__(self, xp: Any, put: Put, limb: Any, of_limbs: Any, of_hinges: Any):
        """Begin with none; *limb* is that of each hinge, (m,); of limbs and hinges are zeros, (k, limbs), (k, m)."""
        self._xp, self._limb = xp, limb
        self._slots = put(np.arange(SLOTS, dtype=np.float64)[None, :, None])
        self._next = of_limbs
        self._length_s = of_limbs[:, None, :] + 0.0 * self._slots + 1.0
        self._time_s = 10.0 * self._length_s
        self._pattern = of_hinges[:, None, :] + 0.0 * self._slots

    def advance(self, step_s: float, begins: Any, lengths_s: Any, patterns: Any) -> None:
        """Let time pass, and bursts of given lengths and patterns of shares, (k, m), begin in limbs, (k, limbs)."""
        xp = self._xp
        is_new = begins[:, None, :] & (xp.abs(self._slots - self._next[:, None, :]) < 0.5)
        self._time_s = xp.where(is_new, 0.0, self._time_s + step_s)
        self._length_s = xp.where(is_new, lengths_s[:, None, :], self._length_s)
        self._pattern = xp.where(xp.take(is_new, self._limb, axis=2), patterns[:, None, :], self._pattern)
        following = xp.where(self._next > SLOTS - 1.5, 0.0, self._next + 1.0)
        self._next = xp.where(begins, following, self._next)

    def shares(self, rebound: Any) -> Any:
        """Return what all of them ask for now, shape (k, m); *rebound* has shape (k, 1)."""
        xp = self._xp
        part = self._time_s / self._length_s
        wave = xp.sin(math.pi * part) ** 2
        first = xp.where(part < 1.0, wave, 0.0)
        second = xp.where((part >= 1.0) & (part < 2.0), wave, 0.0)
        shape = first - rebound[:, :, None] * second
        return xp.sum(self._pattern * xp.take(shape, self._limb, axis=2), axis=1)


def probabilities(xp: Any, law: Mapping[str, Any], rate_hz: Any, swell: Any, arousal: Any, activity: Any) -> Any:
    """Return the rates at which bursts begin now, [1/s]: in all limbs, in a pair, and in each limb by itself.

    With the arousal a and the activity x of a limb, both of variance 1, the rate is λ exp(s a - s²/2) of all, and that
    times exp(l x - l²/2) of each limb by itself, with the swells s and l, so that λ is their mean over time.
    """
    common = rate_hz * xp.exp(swell * arousal - swell**2 / 2)
    alone = common * xp.exp(law["limb_swell"] * activity - law["limb_swell"] ** 2 / 2)
    alone = alone * (1.0 - law["together"] - law["whole"])
    return common * law["whole"], common * law["together"], alone


class Columns:
    """The names of the columns of an array of shape (k, width), in their order."""

    def __init__(self, widths: Mapping[str, int]):
        self._slices: dict[str, slice] = {}
        self.width = 0
        """Number of all columns."""
        for name, width in widths.items():
            self._slices[name] = slice(self.width, self.width + width)
            self.width += width

    def split(self, array: Any) -> dict[str, Any]:
        """Return the columns of each name, shape (k, width of the name)."""
        return {name: array[:, columns] for name, columns in self._slices.items()}


SMOOTHING_S = 0.25  # Time constant in which slow drives and movements towards goals set in.
FIDGET_S = 0.6  # Time constant in which fidgety movements lose their rhythm.


STYLED = {
    "strength": "strength",
    "rate": "rate_hz",
    "duration": "duration_s",
    "swell": "swell",
    "slow": "slow",
    "tone": "tone",
    "arms": "arms",
}
"""By the name of a trait, the number of `Law` that it multiplies."""


class GeneralMovements:
    """The spontaneous movement of k infants with the same commands.

    Each control step needs `uniforms` and `normals` random numbers of each infant, and the start `starts` normal ones:

        movement = GeneralMovements(joints, [law_at(3.0)] * k, step_s=0.01)
        movement.start(normal)                              # (k, starts)
        commands = movement.step(uniform, normal, arousal)  # (k, uniforms), (k, normals), (k, 1) -> (k, n)

    `draw` gives them from a generator of each infant. On a device, they are what its library draws, in arrays of these
    shapes.
    """

    def __init__(
        self,
        joints: Joints,
        laws: Sequence[Law],
        step_s: float,
        styles: Styles = STYLES,
        xp: Any = NUMPY,
        put: Put = np.asarray,
    ):
        """Prepare the movement of infants, a law for each; *put* moves NumPy's arrays into *xp*."""
        self._xp, self._put, self._step_s, self._styles = xp, put, step_s, styles
        limbs, hinges = len(LIMBS), len(joints.names)
        by_limb = dict.fromkeys(("activity", "bend", "size", "duration", "direction"), limbs)
        by_hinge = dict.fromkeys(("slow", "fidget", "pattern"), hinges)
        self._normals = Columns({"arousal": 1, **by_limb, **by_hinge})
        self._uniforms = Columns({"alone": limbs, "goal": limbs, "choice": limbs, "arms": 1, "legs": 1, "all": 1})
        traits = {f"style_{name}": 1 for name in TRAITS}
        state = {"arousal": 1, "activity": limbs, "bend": limbs, "lasting_bend": limbs}
        state |= dict.fromkeys(("slow", "fidget", "quadrature", "lasting"), hinges)
        self._starts = Columns(traits | state)
        self.uniforms, self.normals, self.starts = self._uniforms.width, self._normals.width, self._starts.width
        self._joints = joints
        self._limb = put(joints.limbs)
        self._hinge = put(joints.hinges)
        self._other_side = put(OTHER_SIDE)
        rows = ("flexion", "distal", "weights", "postures", "goals", "to_head", "signs", "is_muscle", "low", "high")
        self._of = {name: put(getattr(joints, name)[None]) for name in rows}
        limbs_of = {"arms": ARMS, "legs": LEGS, "trunk": TRUNK, "left": IS_LEFT}
        slots = np.full(hinges, len(joints.neck), np.intp)  # Of hinges that do not turn the head, there is a zero.
        slots[joints.neck] = np.arange(len(joints.neck))
        self._neck_slot, self._neck_rest_rad = put(slots), put(joints.neck_rest_rad[None])
        self._limbs_of = {name: put(array[None]) for name, array in limbs_of.items()}
        self._set_laws(laws)
        self.rate_gains = put(np.ones((1, limbs)))
        """Factor on how often bursts of each limb by itself begin, shape (k, 6) or (1, 6), in the order of `LIMBS`."""

    def start(self, normal: Any) -> None:
        """Draw styles from standard normal numbers, shape (k, starts), and begin in the midst of movement."""
        self._state = self._starts.split(normal)
        self._state |= {"slowly": self._state["slow"], "slowly_bend": self._state["bend"]}
        zeros = 0.0 * self._state["slow"]
        self._state |= {"goal": zeros, "going": zeros, "touch": zeros, "touching": zeros}
        self._bursts = Bursts(self._xp, self._put, self._limb, 0.0 * self._state["activity"], zeros)
        self._set_styles()

    def set_laws(self, laws: Sequence[Law]) -> None:
        """Change the law of each infant in the midst of its movement, as when it has grown; its style stays."""
        self._set_laws(laws)
        self._set_styles()

    def step(self, uniform: Any, normal: Any, arousal: Any = 1.0, neck: Turned | None = None) -> Any:
        """Return the commands of the next control step, shape (k, n).

        Args:
            uniform: Numbers from 0 to 1, shape (k, uniforms).
            normal: Standard normal numbers, shape (k, normals).
            arousal: How awake the infants are, shape (k, 1), or one number: 0 is not at all, 1 quiet.
            neck: What is felt of the hinges `Joints.neck`; None if nothing is, and the head lies where it falls.
        """
        chances = self._uniforms.split(uniform)
        noise = self._normals.split(normal)
        state = self._state
        for name, seconds in (
            ("arousal", "swell_s"),
            ("activity", "limb_swell_s"),
            ("bend", "slow_s"),
            ("slow", "slow_s"),
        ):
            state[name] = self._drifted(state[name], noise[name], self._law[seconds])
        ease = 1.0 - math.exp(-self._step_s / SMOOTHING_S)
        for name, target in (("slowly_bend", "bend"), ("slowly", "slow")):
            state[name] = state[name] + ease * (state[target] - state[name])
        self._oscillate(noise["fidget"])
        self._begin_bursts(chances, noise, arousal)
        self._aim(chances, ease, arousal)
        shares = self._shares(arousal)
        if neck is not None:
            shares = shares + self._to_midline(neck, arousal)
        return self._commands(shares, arousal)

    def _set_laws(self, laws: Sequence[Law]) -> None:
        self._law = {name: self._put(np.array([[asdict(law)[name]] for law in laws])) for name in asdict(laws[0])}

    def _set_styles(self) -> None:
        """Compute what differs between infants, from their styles and the law of their age."""
        xp, law, of, state = self._xp, self._law, self._limbs_of, self._state
        scaled = {
            name: law.get(key, 1.0) * xp.exp(getattr(self._styles, name) * state[f"style_{name}"])
            for name, key in STYLED.items()
        }
        self._size = scaled["strength"] * (of["arms"] * scaled["arms"] + of["legs"] + of["trunk"] * law["trunk"])
        side = self._styles.side * state["style_side"] * (2.0 * of["left"] - of["arms"] - of["legs"])
        self._rate_hz = scaled["rate"] * xp.exp(side)
        self._duration_s = scaled["duration"] * (of["legs"] * law["leg_duration"] + (1.0 - of["legs"]))
        self._swell, self._tone = scaled["swell"], scaled["tone"]
        self._weight = self._of["weights"] * (1.0 - self._of["distal"] + law["distal"] * self._of["distal"])
        in_limbs = of["arms"] + of["legs"] + of["trunk"] * law["trunk"]
        self._scale = xp.take(in_limbs, self._limb, axis=1) * self._weight
        self._slow = scaled["slow"] * self._scale
        self._in_phase = of["arms"] * law["arms_in_phase"] + of["legs"] * law["legs_in_phase"]
        lasting = xp.take(self._styles.limbs * state["lasting_bend"], self._limb, axis=1) * self._of["flexion"]
        self._posture = (lasting + self._styles.posture * state["lasting"]) * self._scale
        for index, name in enumerate(POSTURES):
            self._posture = self._posture + law[name] * self._of["postures"][:, index, :]

    def _drifted(self, value: Any, normal: Any, seconds: Any) -> Any:
        """Return an Ornstein-Uhlenbeck process of variance 1 a step later: k x + √(1 - k²) n, k = exp(-Δt / τ)."""
        keep = self._xp.exp(-self._step_s / seconds)
        return keep * value + self._xp.sqrt(1.0 - keep**2) * normal

    def _oscillate(self, normal: Any) -> None:
        """Turn the fidgety drives, two numbers a joint, by a step, and let chance disturb their rhythm."""
        xp = self._xp
        state = self._state
        angle = 2.0 * math.pi * self._step_s * self._law["fidget_hz"]
        keep = math.exp(-self._step_s / FIDGET_S)
        cos = xp.cos(angle)
        sin = xp.sin(angle)
        former = state["fidget"]
        quadrature = state["quadrature"]
        state["fidget"] = keep * (cos * former - sin * quadrature) + math.sqrt(2.0 * (1.0 - keep**2)) * normal
        state["quadrature"] = keep * (sin * former + cos * quadrature)

    def _begin_bursts(self, chances: Mapping[str, Any], noise: Mapping[str, Any], arousal: Any) -> None:
        """Let bursts begin: in a limb by itself, in both arms or both legs, or in all limbs."""
        xp, law, state, of = self._xp, self._law, self._state, self._limbs_of
        rates = probabilities(xp, law, self._rate_hz, self._swell, state["arousal"], state["activity"])
        of_all, of_pairs, alone = (rate * arousal * self._step_s for rate in rates)
        in_arms, in_legs = ((of[name] > 0.0) & (chances[name] < of_pairs) for name in ("arms", "legs"))
        together = in_arms | in_legs | (chances["all"] < of_all)
        begins = (chances["alone"] < alone * self.rate_gains) | together
        direction = xp.where(together, self._in_pairs(noise["direction"]), noise["direction"])
        lengths_s = self._duration_s * xp.exp(law["duration_spread"] * noise["duration"])
        sizes = xp.exp(law["size_spread"] * noise["size"] + law["size_swell"] * state["arousal"])
        sizes = self._size * sizes * arousal
        patterns = self._along(direction, noise["pattern"]) * self._weight * xp.take(sizes, self._limb, axis=1)
        self._bursts.advance(self._step_s, begins, lengths_s, patterns)

    def _in_pairs(self, of_limbs: Any) -> Any:
        """Return numbers of limbs, those on the left correlated with those on the right: r x_right + √(1 - r²) x."""
        xp = self._xp
        same = self._in_phase * xp.take(of_limbs, self._other_side, axis=1)
        same = same + xp.sqrt(1.0 - self._in_phase**2) * of_limbs
        return xp.where(self._limbs_of["left"] > 0.0, same, of_limbs)

    def _along(self, of_limbs: Any, of_hinges: Any) -> Any:
        """Return what is partly of the whole limb, partly of each joint: c f b + √(1 - c²) j, shape (k, m)."""
        xp, coherence = self._xp, self._law["coherence"]
        along = coherence * self._of["flexion"] * xp.take(of_limbs, self._limb, axis=1)
        return along + xp.sqrt(1.0 - coherence**2) * of_hinges

    def _aim(self, chances: Mapping[str, Any], ease: float, arousal: Any) -> None:
        """Let limbs leave for another goal, and arms for the head or back; both by the same chances."""
        xp, state, goals = self._xp, self._state, self._of["goals"]
        leaves = xp.take(chances["goal"] < self._law["goals_hz"] * arousal * self._step_s, self._limb, axis=1)
        count = goals.shape[1]
        choice = xp.take(chances["choice"], self._limb, axis=1) * (count + 1)
        chosen = 0.0 * choice
        for index in range(count):
            chosen = xp.where((choice >= index) & (choice < index + 1), goals[:, index, :], chosen)
        state["goal"] = xp.where(leaves, chosen, state["goal"])
        moves = xp.take(chances["goal"] < self._law["touch_hz"] * arousal * self._step_s, self._limb, axis=1)
        is_there = xp.take(chances["choice"] < self._law["touch_share"], self._limb, axis=1)
        state["touch"] = xp.where(moves, xp.where(is_there, self._of["to_head"], 0.0), state["touch"])
        for name, target in (("going", "goal"), ("touching", "touch")):
            state[name] = state[name] + ease * (state[target] - state[name])

    def _shares(self, arousal: Any) -> Any:
        law, state = self._law, self._state
        slowly = self._slow * self._along(self._in_pairs(state["slowly_bend"]), state["slowly"])
        level = self._xp.exp(law["size_swell"] * state["arousal"]) * arousal
        fidgety = law["fidget"] * self._scale * level * state["fidget"]
        aimed = law["goals"] * state["going"] + law["touch"] * state["touching"]
        return self._posture + slowly + fidgety + self._bursts.shares(law["rebound"]) + aimed

    def _to_midline(self, neck: Turned, arousal: Any) -> Any:
        """Return what brings the head to the midline, g min(a, 1) (p (q0 - q) - d v), as shares of shape (k, m)."""
        xp = self._xp
        away_rad = self._neck_rest_rad - neck.angles_rad
        shares = self._law["midline"] * (MIDLINE_PER_RAD * away_rad - MIDLINE_PER_RAD_S * neck.speeds_rad_s)
        none = 0.0 * self._state["arousal"]
        awake = xp.minimum(none + arousal, none + 1.0)
        return xp.take(xp.concat([awake * shares, none], axis=1), self._neck_slot, axis=1)

    def _commands(self, shares: Any, arousal: Any) -> Any:
        xp, of = self._xp, self._of
        shares = xp.concat([shares, 0.0 * self._state["arousal"]], axis=1)
        commands = of["signs"] * xp.take(shares, self._hinge, axis=1) + of["is_muscle"] * self._tone * arousal
        return xp.minimum(xp.maximum(commands, of["low"]), of["high"])


def draw(generators: Sequence[np.random.Generator], uniforms: int, normals: int) -> tuple[FloatArray, FloatArray]:
    """Return random numbers of k infants, each from its own generator, shapes (k, uniforms) and (k, normals)."""
    uniform, normal = np.empty((len(generators), uniforms)), np.empty((len(generators), normals))
    for generator, uniform_row, normal_row in zip(generators, uniform, normal, strict=True):
        generator.random(out=uniform_row)
        generator.standard_normal(out=normal_row)
    return uniform, normal


class Moving:
    """Moves infants with the same commands by themselves, as the law of their age and their arousal say.

    The style of each is drawn from its generator in the first step. It stays, also when the infant grows, and movement
    goes on through episodes: limbs and trunk do not depend on what an infant senses. The head does, which it keeps in
    the midline by the angles of the neck that it feels (`FeltHinges`).
    """

    def __init__(self, batch: Batch):
        first = batch.infants[0]
        self._batch = batch
        self._started = False
        self._ages = [infant.manifest.child.corrected_age_months for infant in batch.infants]
        joints = joints_of(first.manifest.actuation, first.actuation)
        laws = [law_at(age) for age in self._ages]
        step_s = ms_to_s(first.manifest.step_ms)
        self.movement = GeneralMovements(joints, laws, step_s, xp=batch.xp, put=batch.put)
        """The generator of their commands."""
        self._neck = FeltHinges(batch, [joints.names[hinge] for hinge in joints.neck])

    def metrics(self) -> Mapping[str, bool]:
        """Return whether the head is kept in the midline by the state of the simulation, without a sense for it."""
        return {} if self._neck.are_sensed else {f"midline_without_{SENSE}": True}

    def __call__(self, generators: Sequence[np.random.Generator], observation: Any) -> Any:
        """Return the actions of the next control step, shape (k, n)."""
        movement = self.movement
        batch = self._batch
        put = self._batch.put
        ages = [infant.manifest.child.corrected_age_months for infant in batch.infants]
        if not self._started:
            movement.start(put(draw(generators, 0, movement.starts)[1]))
            self._started = True
        if ages != self._ages:
            movement.set_laws([law_at(age) for age in ages])
            self._ages = ages
        uniform, normal = draw(generators, movement.uniforms, movement.normals)
        return batch.actions(movement.step(put(uniform), put(normal), batch.arousals(), self._neck(observation)))
