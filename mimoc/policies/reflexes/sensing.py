"""The stimuli of reflexes: touch by areas of skin, joints by name, and balance."""

import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from mimoc.base.units import GRAVITY_M_S2, ms_to_s
from mimoc.policies.policy import Batch
from mimoc.runtime.sense import FloatArray, IntArray

SIDES = ("right", "left")


@dataclass(frozen=True, slots=True)
class Patch:
    """A box on one kind of body, of the right side; on the left, y is mirrored.

    Body frames: x of head and feet is forwards and z upwards; z of hands and fingers points to the tips, and -y of the
    right hand is where the palm is.
    """

    bodies: str
    inward: tuple[float, float, float]
    """Direction in which something presses on it, in the frame of the body; used where touch is the sum of the forces
    on each body."""
    low: tuple[float, float, float] = (0.0, 0.0, 0.0)
    """The corner with the least coordinates, as shares of the box around all skin points of the body."""
    high: tuple[float, float, float] = (1.0, 1.0, 1.0)  # The opposite corner.


AREAS: Mapping[str, tuple[Patch, ...]] = {
    "palm": (Patch("{side}_hand", (0, 1, 0), high=(1, 0.35, 1)),),
    "cheek": (Patch("head", (0, 1, 0), (0.55, 0.0, 0.05), (0.97, 0.35, 0.55)),),
    "sole": (Patch("{side}_(foot|toes|big_toe)", (0, 0, 1), high=(1, 1, 0.35)),),
    "ball": (
        Patch("{side}_foot", (0, 0, 1), (0.65, 0, 0), (1, 1, 0.35)),
        Patch("{side}_(toes|big_toe)", (0, 0, 1), high=(1, 1, 0.35)),
    ),
    "foot back": (Patch("{side}_(foot|toes|big_toe)", (0, 0, -1), low=(0, 0, 0.65)),),
}


class Area:
    """How hard something presses on one area of k infants, in [N]."""

    def __init__(self, batch: Batch, side: str, patches: tuple[Patch, ...], width: int, is_sum: bool):
        """Find the numbers of touch that belong to it, *width* a point; *is_sum* adds the forces on each body."""
        self._xp = batch.xp
        self._width = width
        touches: list[Any] = [infant.senses["touch"] for infant in batch.infants]
        if is_sum:
            indices, weights = _bodies(touches[0].receptors, side, patches)
            self._directions = batch.put(weights[None]) if width == 3 and _is_in_body(batch) else None
            weights = np.ones((len(touches), len(indices)))
        else:
            inside = np.stack([_inside(touch.receptors, side, patches) for touch in touches])
            indices = np.flatnonzero(inside.any(axis=0))
            self._directions = None
            weights = inside[:, indices].astype(np.float64)
        self._numbers = batch.put((indices[:, None] * width + np.arange(width)).ravel().astype(np.intp))
        self._weights = batch.put(weights)
        self._points = len(indices)

    def __call__(self, touch: Any) -> Any:
        """Return the force on the area, shape (k,), from observations of touch, shape (k, numbers)."""
        xp = self._xp
        forces = xp.reshape(xp.take(touch, self._numbers, axis=1), (touch.shape[0], self._points, self._width))
        if self._directions is not None:
            sizes = xp.maximum(xp.sum(forces * self._directions, axis=2), 0.0 * forces[:, :, 0])
        else:
            sizes = xp.sqrt(xp.sum(forces * forces, axis=2))
        return xp.sum(sizes * self._weights, axis=1)


def _inside(receptors: Any, side: str, patches: tuple[Patch, ...]) -> np.ndarray:
    """Return which points of one infant are in an area, shape (n,)."""
    inside = np.zeros(len(receptors.names), bool)
    for body in np.unique(receptors.names):
        is_on = receptors.names == body
        for patch in patches:
            if re.fullmatch(patch.bodies.format(side=side), body):
                places = receptors.points_m[is_on] * ([1, 1, 1] if side == "right" else [1, -1, 1])
                least = places.min(axis=0)
                shares = (places - least) / np.maximum(places.max(axis=0) - least, 1e-9)
                inside[is_on] |= ((shares >= patch.low) & (shares <= patch.high)).all(axis=1)
    return inside


def _bodies(receptors: Any, side: str, patches: tuple[Patch, ...]) -> tuple[IntArray, FloatArray]:
    """Return the bodies of an area, as numbers among those with skin, and the directions of pressure, shape (m, 3)."""
    names = receptors.names[np.unique(receptors.bodies, return_index=True)[1]].tolist()
    chosen = [
        (number, np.array(patch.inward) * ([1, 1, 1] if side == "right" else [1, -1, 1]))
        for number, name in enumerate(names)
        for patch in patches
        if re.fullmatch(patch.bodies.format(side=side), name)
    ]
    numbers = np.array([number for number, _ in chosen], np.intp)
    return numbers, np.array([direction for _, direction in chosen], np.float64).reshape(-1, 3)


def _is_in_body(batch: Batch) -> bool:
    entry: Any = batch.infants[0].manifest.senses.touch
    return entry.quantity == "force_vector"


GRAVITY_S = 0.5
"""Time constant with which the direction upwards follows the specific force; faster turns come from the gyroscope."""
POSTURE_S = 1.0  # Time constant of the posture that an infant was in before it tipped over.
NECK = ("head_tilt_side", "head_tilt", "head_swivel")  # The joints between trunk and head that turn about x, y and z.
UP = ("up x", "up y", "up z")  # Names of the parts of the direction upwards in the state of the sense of balance.
BALANCE = {**dict.fromkeys(UP, 0.0), "posture": 0.0, "is new": 1.0}
"""State of the sense of balance when an episode begins."""


@dataclass(frozen=True)
class Sensed:
    """The stimuli that k infants sense in one control step; arrays have the shape (k,)."""

    xp: Any
    step_s: float
    weight_n: Any
    pressure_n: Mapping[str, Any]  # Force on each area of skin, such as `right palm`; empty without touch.
    angle_rad: Mapping[str, Any]  # Angle of each joint, such as `right_elbow`; empty without proprioception.
    speed_rad_s: Mapping[str, Any]
    head_rate_rad_s: tuple[Any, Any, Any]
    """Angular velocity of the head in its frame: x forwards, y left, z up; zeros without a vestibular sense."""
    head_force_m_s2: tuple[Any, Any, Any]  # Specific force of the head, which is gravity's reaction at rest.
    rate_rad_s: tuple[Any, Any, Any]  # Angular velocity of the trunk in its frame, as far as the neck is sensed.
    up: tuple[Any, Any, Any]  # Unit vector upwards in the frame of the trunk: (0, 0, 1) of an infant that is upright.
    posture: Any  # The upward part of `up` over the last second: about 1 of an infant that was upright.
    chance: Any  # A number from 0 to 1 for each control step.

    @cached_property
    def zero(self) -> Any:
        """Zeros, of the right shape and kind."""
        return 0.0 * self.chance

    def pressure(self, area: str) -> Any:
        """Return the force on an area as a share of the body's weight."""
        return self.pressure_n.get(area, self.zero) / self.weight_n

    def angle(self, joint: str) -> Any:
        """Return the angle of a joint; zero if it is not sensed."""
        return self.angle_rad.get(joint, self.zero)

    def speed(self, joint: str) -> Any:
        """Return the velocity of a joint; zero if it is not sensed."""
        return self.speed_rad_s.get(joint, self.zero)

    def clip(self, values: Any) -> Any:
        """Return values within 0 and 1."""
        return self.xp.clip(values, 0.0, 1.0)

    def keep(self, seconds: float) -> float:
        """Return the share of something that decays with a time constant that is left after a control step."""
        return float(np.exp(-self.step_s / seconds))

    def hold(self, former: Any, stimulus: Any, seconds: float) -> Any:
        """Return a stimulus that outlasts itself: it rises at once and decays with a time constant."""
        return self.xp.maximum(stimulus, self.keep(seconds) * former)


JOINTS = (*NECK, *(f"{side}_{name}" for side in SIDES for name in ("fingers", "mf_knuckle")))


class Senses:
    """Reads observations of k infants; bound to their bodies."""

    def __init__(self, batch: Batch, touch_numbers: int):
        """Find what is read; *touch_numbers* is how many numbers an observation of touch has, 0 without."""
        self._batch = batch
        infant = batch.infants[0]
        senses = [name for name in ("proprioception", "vestibular", "touch") if name in infant.senses]
        self.names = tuple(senses)
        """The senses that there are."""
        self._step_s = ms_to_s(infant.manifest.step_ms)
        weights_kg = np.array([item.manifest.child.weight_kg for item in batch.infants])
        self._weight_n = batch.put(GRAVITY_M_S2 * weights_kg)
        self._areas: dict[str, Area] = {}
        if "touch" in senses and touch_numbers:
            touch: Any = infant.senses["touch"]
            is_sum = touch_numbers != len(touch.bodies)
            self._areas = {
                f"{side} {name}": Area(batch, side, patches, touch.width, is_sum)
                for side in SIDES
                for name, patches in AREAS.items()
            }
        layout = infant.layout("proprioception") if "proprioception" in senses else ()
        self._angles = {name: layout.index(f"robot:{name} angle [rad]") for name in _sensed(layout, "angle [rad]")}
        self._speeds = {name: layout.index(f"robot:{name} velocity [rad/s]") for name in _sensed(layout, "velocity")}
        of_head = infant.layout("vestibular") if "vestibular" in senses else ()
        self._force_columns = [column for column, name in enumerate(of_head) if "_acc." in name]
        self._rate_columns = [column for column, name in enumerate(of_head) if "_gyro." in name]

    def __call__(self, observation: Mapping[str, Any], balance: Mapping[str, Any], chance: Any) -> tuple[Sensed, dict]:
        """Return what is sensed, and what balance remembers (`BALANCE`), by chances from 0 to 1, shape (k,)."""
        real = self._batch.real
        zero = 0.0 * chance
        joints = real(observation["proprioception"]) if self._angles else None
        angles = {name: joints[:, index] for name, index in self._angles.items()} if joints is not None else {}
        speeds = {name: joints[:, index] for name, index in self._speeds.items()} if joints is not None else {}
        touch = real(observation["touch"]) if self._areas else None
        force, rate = self._head(observation, zero)
        neck = [angles.get(name, zero) for name in NECK]
        # The head turns as the trunk does, and as the neck turns it.
        turning = [of_head - speeds.get(name, zero) for of_head, name in zip(rate, NECK, strict=True)]
        rate_of_trunk = _in_trunk(self._batch.xp, turning, neck)
        balance = self._balanced(balance, _in_trunk(self._batch.xp, force, neck), rate_of_trunk)
        sensed = Sensed(
            xp=self._batch.xp,
            step_s=self._step_s,
            weight_n=self._weight_n,
            pressure_n={name: area(touch) for name, area in self._areas.items()},
            angle_rad=angles,
            speed_rad_s=speeds,
            head_rate_rad_s=rate,
            head_force_m_s2=force,
            rate_rad_s=rate_of_trunk,
            up=(balance["up x"], balance["up y"], balance["up z"]),
            posture=balance["posture"],
            chance=chance,
        )
        return sensed, balance

    def _head(self, observation: Mapping[str, Any], zero: Any) -> tuple[tuple[Any, ...], tuple[Any, ...]]:
        """Return specific force and angular velocity of the head; zeros for what is not sensed."""
        nothing = (zero, zero, zero)
        if not (self._force_columns or self._rate_columns):
            return nothing, nothing
        vestibular = self._batch.real(observation["vestibular"])
        force = tuple(vestibular[:, column] for column in self._force_columns) or nothing
        rate = tuple(vestibular[:, column] for column in self._rate_columns) or nothing
        return force, rate

    def _balanced(self, former: Mapping[str, Any], force: Any, rate: Any) -> dict[str, Any]:
        """Return the direction upwards one step later: turned as the gyroscope says, drawn towards the specific force.

        With the angular velocity w, the specific force f and the time constant T: up' = up x w + (f / |f| - up) / T.
        """
        xp = self._batch.xp
        step_s = self._step_s
        size = xp.sqrt(force[0] ** 2 + force[1] ** 2 + force[2] ** 2) + 1e-6
        measured = tuple(part / size for part in force)
        new = former["is new"]
        up = tuple(new * part + (1.0 - new) * former[name] for part, name in zip(measured, UP, strict=True))
        turned = (
            up[1] * rate[2] - up[2] * rate[1],
            up[2] * rate[0] - up[0] * rate[2],
            up[0] * rate[1] - up[1] * rate[0],
        )
        moved = [
            old + step_s * (turn + (goal - old) / GRAVITY_S)
            for old, turn, goal in zip(up, turned, measured, strict=True)
        ]
        length = xp.sqrt(moved[0] ** 2 + moved[1] ** 2 + moved[2] ** 2) + 1e-6
        moved = [part / length for part in moved]
        posture = new * moved[2] + (1.0 - new) * former["posture"]
        posture = posture + step_s / POSTURE_S * (moved[2] - posture)
        return {**dict(zip(UP, moved, strict=True)), "posture": posture, "is new": 0.0 * new}


def _sensed(layout: tuple[str, ...], what: str) -> list[str]:
    return [name for name in JOINTS if any(item.startswith(f"robot:{name} {what}") for item in layout)]


def _in_trunk(xp: Any, vector: Any, neck: Any) -> tuple[Any, Any, Any]:
    """Return a vector of the head's frame in the frame of the trunk; the neck turns about z, then y, then x."""
    x, y, z = vector
    roll, pitch, yaw = neck
    y, z = xp.cos(roll) * y - xp.sin(roll) * z, xp.sin(roll) * y + xp.cos(roll) * z
    x, z = xp.cos(pitch) * x + xp.sin(pitch) * z, xp.cos(pitch) * z - xp.sin(pitch) * x
    return xp.cos(yaw) * x - xp.sin(yaw) * y, xp.sin(yaw) * x + xp.cos(yaw) * y, z
