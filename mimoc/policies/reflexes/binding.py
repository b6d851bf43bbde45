"""The policy `reflexes` of one infant, or of many."""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from mimoc.base.errors import PolicyError
from mimoc.policies.control.actuators import pulls_of
from mimoc.policies.policy import Batch
from mimoc.policies.reflexes.repertoire import REFLEXES, Reflex
from mimoc.policies.reflexes.sensing import BALANCE, SIDES, Senses
from mimoc.runtime.actuation import commanded
from mimoc.runtime.sense import FloatArray

FINGERS = "(ff|mf|rf|lf)_(knuckle|middle|distal)|thumb_(middle|distal)"  # Joints that bend five fingers.
MOVEMENTS: Mapping[str, tuple[tuple[str, int], ...]] = {
    "shoulder abduction": (("shoulder_abduction", 1),),
    "shoulder adduction": (("shoulder_abduction", -1),),
    "arm forwards": (("shoulder_horizontal", 1),),
    "arm backwards": (("shoulder_horizontal", -1),),
    "elbow extension": (("elbow", 1),),
    "elbow flexion": (("elbow", -1),),
    "finger flexion": (("fingers", -1), (FINGERS, 1)),
    "finger extension": (("fingers", 1), (FINGERS, -1)),
    "hip flexion": (("hip_flex", -1),),
    "hip extension": (("hip_flex", 1),),
    "knee flexion": (("knee", -1),),
    "knee extension": (("knee", 1),),
    "foot dorsiflexion": (("foot_flexion", 1),),
    "toe flexion": (("toes|big_toe", -1),),
}
"""Movements of each side: patterns of actuators without the side, and whether they turn their joint towards positive or
negative angles. Mitten hands bend their one finger towards negative angles, five fingers towards positive ones."""
HEAD: Mapping[str, tuple[tuple[str, int], ...]] = {
    "head turn left": (("head_swivel", 1),),
    "head turn right": (("head_swivel", -1),),
}


def command_rows(batch: Batch) -> dict[str, FloatArray]:
    """Return the commands of each movement, such as `right elbow flexion`, in full strength, shape (n,).

    A muscle pulls one way: it is commanded 1 if that is the way of the movement, else 0. A motor turns with all of its
    torque, a servo goes to the end of the joint's range: 1 or -1.
    """
    infant = batch.infants[0]
    pulls = pulls_of(infant.actuation)
    names = [item.mimo_actuator.removeprefix("act:") for item in commanded(infant.manifest.actuation)]
    movements = dict(HEAD)
    for side in SIDES:
        for name, patterns in MOVEMENTS.items():
            movements[f"{side} {name}"] = tuple((f"{side}_({pattern})", sign) for pattern, sign in patterns)
    rows = dict[str, FloatArray]()
    for movement, patterns in movements.items():
        rows[movement] = row = np.zeros(len(names))
        for pattern, sign in patterns:
            matches = np.array([re.fullmatch(pattern, name) is not None for name in names])
            whole = np.where(pulls == 0, float(sign), (pulls == sign) * 1.0)
            row[matches] = whole[matches]
    return rows


NOTICED = 0.05  # Drive from which on a reflex counts as acting.
MAX_MONTHS = 12.0  # By which reflexes of a child can be late or early.


class Reflexes:
    """The reflexes of k infants: commands that add to others', from what they sensed.

    The command of an actuator is r + Σ gain · drive · c over the movements of all reflexes, within its range, where r
    is the command at rest, and c that of the whole movement; a reflex whose sense an infant lacks does nothing.
    """

    def __init__(self, batch: Batch, late_months: float | FloatArray = 0.0, reflexes: Mapping[str, Reflex] = REFLEXES):
        """Bind reflexes, all of them or each, shape (k,), *late_months* later than in most children."""
        self._batch, self._late_months, self._reflexes = batch, late_months, reflexes
        self._count = len(batch.infants)
        infant = batch.infants[0]
        self.idle = {
            name: missing[0]
            for name, reflex in reflexes.items()
            if (missing := [sense for sense in reflex.senses if sense not in infant.senses])
        }
        """Reflexes that do nothing for want of a sense, with the sense."""
        self._steps, self._acting = 0, {name: 0.0 * batch.put(np.zeros(self._count)) for name in reflexes}
        self._senses: Senses | None = None
        self.gains = dict[str, Any]()
        """Gains at the ages of the last step, shape (k,), of the reflexes that any of them has."""
        self._had = set[str]()
        self._bundles: tuple[Any, ...] = ()
        self._state: dict[str, Mapping[str, Any]] = self._first()

    def __call__(self, generators: Sequence[np.random.Generator], observations: Mapping[str, Any]) -> Any:
        """Return the actions, shape (k, n); each generator gives one number."""
        senses = self._bind(observations)
        chance = self._batch.draw([generator.random() for generator in generators])
        sensed, balance = senses(observations, self._state[""], chance)
        state, total = {**self._state, "": balance}, dict[str, Any]()
        for name, gain in self.gains.items():
            drives, state[name] = self._reflexes[name].run(sensed, self._state[name])
            most = sensed.zero
            for movement, drive in drives.items():
                total[movement] = total.get(movement, sensed.zero) + gain * drive
                most = sensed.xp.maximum(most, drive)
            self._acting[name] = self._acting[name] + (gain * most > NOTICED) * 1.0
        self._state, self._steps = state, self._steps + 1
        command = self._rest
        for movement, drive in total.items():
            command = command + drive[:, None] * self._rows[movement]
        return self._batch.actions(sensed.xp.minimum(sensed.xp.maximum(command, self._low), self._high))

    def reset(self, rows: Any = True) -> None:
        """Let the infants of some rows forget what they sensed, a boolean array of shape (k,); by default all."""
        rows = self._batch.put(
            np.broadcast_to(np.asarray(rows.cpu() if hasattr(rows, "cpu") else rows, bool), self._count)
        )
        self._forget(dict.fromkeys(self._state, rows))

    def _forget(self, rows: Mapping[str, Any]) -> None:
        """Let some reflexes forget what infants in some rows sensed, boolean arrays of shape (k,)."""
        first, xp = self._first(), self._batch.xp
        for name, chosen in rows.items():
            values = self._state[name].items()
            self._state[name] = {key: xp.where(chosen, first[name][key], value) for key, value in values}

    def metrics(self) -> dict[str, float]:
        """Return the share of control steps in which each reflex of their ages acted, and which ones lack a sense."""
        steps = max(1, self._steps) * self._count
        shares = {
            f"{name}_share": float(self._acting[name].sum()) / steps
            for name in self._reflexes
            if name not in self.idle and name in self._had
        }
        return {**shares, **{f"{name}_without_{sense}": True for name, sense in self.idle.items()}}

    def _first(self) -> dict[str, Mapping[str, Any]]:
        starts = {"": BALANCE, **{name: reflex.start for name, reflex in self._reflexes.items()}}
        return {
            name: {key: self._batch.put(np.full(self._count, value)) for key, value in start.items()}
            for name, start in starts.items()
            if name not in self.idle
        }

    def _bind(self, observations: Mapping[str, Any]) -> Senses:
        """Look again at what depends on the bodies and their ages, if any has changed; return the senses."""
        batch = self._batch
        bundles = tuple(infant.bundle for infant in batch.infants)
        if self._senses is not None and all(a is b for a, b in zip(bundles, self._bundles, strict=True)):
            return self._senses
        self._bundles = bundles
        self._senses = senses = Senses(batch, observations["touch"].shape[-1] if "touch" in observations else 0)
        self._rows = {name: batch.put(row[None]) for name, row in command_rows(batch).items()}
        low, high = batch.limits()
        self._low, self._high, self._rest = map(batch.put, (low, high, np.clip(0.0, low, high)))
        ages = np.array([infant.manifest.child.corrected_age_months for infant in batch.infants]) - self._late_months
        gains = {name: self._reflexes[name].ages.gain(ages) for name in self._reflexes if name not in self.idle}
        never = batch.put(np.zeros(self._count))
        self._forget({name: self.gains.get(name, never) == 0 for name in gains})
        self.gains = {name: batch.put(gain) for name, gain in gains.items() if gain.any()}
        self._had |= self.gains.keys()
        return senses


def bind_many(batch: Batch, late_months: str = "0") -> Reflexes:
    """Return the policy for many infants, see `Reflexes`; PolicyError if its argument is no number of months."""
    try:
        months = float(late_months)
    except ValueError:
        months = float("nan")
    if not abs(months) <= MAX_MONTHS:
        raise PolicyError(
            f"'reflexes:{late_months}': expected by how many months they are late, from -{MAX_MONTHS:g} to "
            f"{MAX_MONTHS:g}; write reflexes:1.5"
        )
    return Reflexes(batch, months)
