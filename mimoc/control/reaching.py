"""Reaching: hands go to targets, and the eyes look at one of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
import numpy.typing as npt

from mimoc.bundle.manifest import Manifest
from mimoc.control.balance import Balance
from mimoc.control.gains import Gains
from mimoc.control.inverse_dynamics import InverseDynamics
from mimoc.control.objectives import LOOKING, REACHING, Align, LookAt, Reach
from mimoc.control.reachable_places import ReachablePlaces
from mimoc.senses.sense import FloatArray


@dataclass(frozen=True, slots=True)
class ReachGains:
    """How strongly hands and eyes go after their targets."""

    hands: Gains = REACHING
    """For the distance of each hand."""
    eyes: Gains = LOOKING
    """For the misalignment of each eye."""


GAIN_SETS: Mapping[str, ReachGains] = {
    "low": ReachGains(Gains(50.0, cap=0.1, viscosity_per_s=10.0), Gains(56.25, viscosity_per_s=15.0)),
    "medium": ReachGains(Gains(200.0, cap=0.1, viscosity_per_s=20.0), Gains(225.0, viscosity_per_s=30.0)),
    "high": ReachGains(),
}
"""Three sets in which the same errors are answered four times as hard as in the one before, and damped alike: that
each reaches faster is what the paper's figure 5 shows."""
GENTLE = "low"
"""Key of `GAIN_SETS` for an infant that sits freely: arms (10 % of its weight) that start at the 80 m/s² of the strong
gains push back with its whole weight and throw it over; at 5 m/s² they do not."""


class ReachController:
    """All hands that take commands reach for a target each, and the eyes look at one of the targets."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, manifest: Manifest, gains: ReachGains | None = None):
        """Bind it to an infant, whose hands stay where they are until they are told otherwise.

        Args:
            model: The infant and its world.
            data: Its state, which each call reads.
            manifest: What its bundle says of it, with motors or muscles.
            gains: For hands and eyes; None is gentle for an infant that sits freely, and strong for all others.

        Raises:
            ControlError: If the infant has servos, or no hand that takes commands.
        """
        self._data, self._balance = data, Balance(model, manifest)
        self._places = ReachablePlaces(model, manifest)
        self.sits_freely = self._balance.sits_freely(data)
        """Whether nothing but the ground held the infant upright when this was made."""
        gains = gains or (GAIN_SETS[GENTLE] if self.sits_freely else ReachGains())
        self._reaches = [Reach(hand, data.body(hand).xipos, gains.hands) for hand in self._places.hands]
        self._looks = [LookAt(eye, self._reaches[0].target, gains=gains.eyes) for eye in self._places.eyes]
        steady, feet = self._balance.objectives(data), self._balance.loose_feet(data)
        self._control = InverseDynamics(model, data, manifest, [*steady, self._reaches, self._looks], loose=feet)
        self._first = sum(isinstance(objective, Align) for objective in steady)

    @property
    def hands(self) -> tuple[str, ...]:
        """Bodies of the hands that reach."""
        return self._places.hands

    @property
    def lies(self) -> bool:
        """Whether the infant lies now."""
        return self._balance.lies(self._data)

    def __call__(self) -> npt.NDArray[np.float32]:
        """Return the action for the present state."""
        return self._control()

    def aim(self, places_m: Sequence[FloatArray], watched: int = 0) -> None:
        """Set the target of each hand, shape (3,), [m]; the eyes look at that of hand number *watched*."""
        for reach, place_m in zip(self._reaches, places_m, strict=True):
            reach.target = place_m
        for look in self._looks:
            look.target = places_m[watched % len(places_m)]

    def draw(self, generator: np.random.Generator) -> tuple[FloatArray, ...] | None:
        """Return a random target for each hand that it can reach, shape (3,), [m]; None if there are none."""
        return self._places.draw(self._data, generator)

    def errors(self) -> tuple[list[float], list[float]]:
        """Return how far each hand [m] and each eye [rad] is from its target now."""
        errors = list(self._control.errors()[self._first :])
        return errors[: len(self._reaches)], errors[len(self._reaches) :]
