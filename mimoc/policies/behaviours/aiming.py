"""What behaviours aim at, when it is noticed, and joints that move a part of the body at a wanted velocity."""

from dataclasses import dataclass
from functools import cached_property

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.policies.behaviours.behaviour import Chance, Reaction, Subject, place_of
from mimoc.policies.control.holding import FREQUENCY_RAD_S
from mimoc.policies.control.infant import DrivenInfant
from mimoc.runtime.sense import FloatArray, IntArray

TOY, HEAD = "toy", "_head"
"""The nearest toy, whichever it is; and how the head of another infant is named behind the infant's name."""


@dataclass(frozen=True)
class Target:
    """Something to look at or to reach for."""

    bodies: tuple[int, ...]
    """The bodies that it may be, of which it is the nearest when an episode begins; none for a place."""
    fixed_m: FloatArray  # The place, shape (3,), if it is one.

    def nearest(self, data: mujoco.MjData, from_m: FloatArray) -> "Target":
        """Return the one body of these that is nearest to a place, shape (3,)."""
        if len(self.bodies) < 2:
            return self
        distances_m = [float(np.linalg.norm(data.xipos[body] - from_m)) for body in self.bodies]
        return Target((self.bodies[int(np.argmin(distances_m))],), self.fixed_m)

    def place_m(self, data: mujoco.MjData) -> FloatArray:
        """Return where it is, shape (3,): the centre of mass of a body."""
        return data.xipos[self.bodies[0]] if self.bodies else self.fixed_m


def find_target(subject: Subject, behaviour: str, word: str) -> Target:
    """Return what a word means: `toy`, the name of a toy, an object or any body in the scene, or a place `(x, y, z)`.

    A place is in metres. A part of the infant's own body is named as if it were alone (`head`), one of another infant
    as in the model (`ben_head`); the name of an infant alone (`ben`) means its head. Raises a PolicyError without a toy
    or for a wrong place, and an UnknownNameError.
    """
    if (place := place_of(word)) is not None:
        return Target((), np.array(place))
    model, toys = subject.infant.model, subject.manifest.toys
    if word == TOY and not toys:
        advice = "add scene.toys to its spec, or name another target, such as a part of the body or '(0.3, 0, 0.2)'"
        raise PolicyError(f"'{behaviour}': there is no toy in this scene; {advice}")
    names: dict[str, list[int]] = {TOY: [model.body(toy.body).id for toy in toys]} if toys else {}
    for toy in toys:
        names.setdefault(toy.object, []).append(model.body(toy.body).id)
    for item in subject.manifest.objects:
        names.setdefault(item.name, [model.body(item.body).id])
    for body in np.flatnonzero(subject.infant.is_own).tolist():
        names.setdefault(subject.infant.part(body), [body])
    for body in range(1, model.nbody):
        names.setdefault(model.body(body).name, [body])
    for name in [name for name in names if name.endswith(HEAD)]:
        names.setdefault(name.removesuffix(HEAD), names[name])
    if word not in names:
        raise UnknownNameError(f"target of '{behaviour}' in this scene", word, names)
    return Target(tuple(names[word]), np.zeros(3))


JUMP_M = 0.05
"""Displacement from one control step to the next from which on a target counts as new there; less is followed."""


class NoticedTarget:
    """A target that is new where it appears, and wherever it jumps to."""

    def __init__(self, target: Target, reaction: Reaction[int] | None, chance: Chance):
        self.target, self._reaction, self._chance = target, reaction, chance
        self._number = 0
        self._seen_m: FloatArray | None = None
        self._known_m: FloatArray | None = None
        if reaction:
            reaction.begin()

    def watch(self, data: mujoco.MjData, time_s: float) -> None:
        """See where it is before a control step."""
        place_m = self.target.place_m(data).copy()
        if self._reaction is None:
            return
        is_new = self._seen_m is None or float(np.linalg.norm(place_m - self._seen_m)) > JUMP_M
        if is_new:
            if self._is_known(time_s):
                self._known_m = self._seen_m
            self._number += 1
            self._reaction.see(self._number, time_s, self._chance.drawn_from)
        self._seen_m = place_m

    def place_m(self, ahead: mujoco.MjData, time_s: float) -> FloatArray | None:
        """Return where it is as far as the infant has reacted to it, shape (3,); None before the first time."""
        return self.target.place_m(ahead) if self._is_known(time_s) else self._known_m

    def _is_known(self, time_s: float) -> bool:
        return self._reaction is None or (self._number > 0 and self._reaction.at(time_s) == self._number)


LEAD_S = 2.0 / FREQUENCY_RAD_S
RESTING_PER_S = 1.0  # How fast joints go back to where they rest, as far as the aim leaves them free.
MARGIN_RAD = 0.02  # How far from the ends of their ranges joints stay.


@dataclass(frozen=True)
class Aim:
    """m joints that move a part of the body at a wanted velocity.

    Joint speeds v follow by damped least squares (Nakamura & Hanafusa 1986), v = W Jᵀ (J W Jᵀ + λ² I)⁻¹ x, with the
    wanted velocities x, their Jacobian J and weights W; what leaves x unchanged pulls joints to where they rest. A
    joint goes to

        angle + (2 / w) v,

    by which the spring K = I w² of the controller just makes up for its damper D = 2 I w, so that it turns at speed v.
    """

    infant: DrivenInfant
    joints: IntArray  # Indices among the driven hinges of the infant, shape (m,).
    weights: FloatArray  # How readily each moves, shape (m,).
    damping: float
    """λ, in [m] for places, without a unit for directions: below it, a direction counts as not reachable."""

    def angles(
        self, ahead: mujoco.MjData, velocity: FloatArray, jacobian: FloatArray, rest_rad: FloatArray
    ) -> FloatArray:
        """Return the angles in range, (m,), to go to for a *velocity*, (k,), with a *jacobian*, (k, nv)."""
        infant = self.infant
        now_rad = ahead.qpos[infant.angles[self.joints]]
        by_joint = jacobian[:, infant.dofs[self.joints]]
        weighted = self.weights[:, None] * by_joint.T
        inverse = weighted @ np.linalg.inv(by_joint @ weighted + self.damping**2 * np.eye(len(velocity)))
        resting = RESTING_PER_S * (rest_rad - now_rad)
        speeds = inverse @ velocity + resting - inverse @ (by_joint @ resting)
        low_rad, high_rad = self._range_rad
        return np.minimum(np.maximum(now_rad + LEAD_S * speeds, low_rad), high_rad)

    @cached_property
    def _range_rad(self) -> tuple[FloatArray, FloatArray]:
        low_rad, high_rad = self.infant.model.jnt_range[self.infant.joints[self.joints]].T
        margin_rad = np.minimum(MARGIN_RAD, (high_rad - low_rad) / 4)
        return low_rad + margin_rad, high_rad - margin_rad
