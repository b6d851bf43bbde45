"""What a behaviour aims at: a toy, another object, a part of the infant's own body or of another's, or a place."""

from dataclasses import dataclass

import mujoco
import numpy as np

from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.policies.behaviours.behaviour import Chance, Reaction, Subject, place_of
from mimoc.runtime.sense import FloatArray

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
