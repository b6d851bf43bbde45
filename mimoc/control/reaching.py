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
    """Gains of hands and eyes."""

    hands: Gains = REACHING
    """Gains for the distance of each hand."""
    eyes: Gains = LOOKING
    """Gains for the misalignment of each eye."""


GAIN_SETS: Mapping[str, ReachGains] = {
    "low": ReachGains(Gains(50.0, cap=0.1, viscosity_per_s=10.0), Gains(56.25, viscosity_per_s=15.0)),
    "medium": ReachGains(Gains(200.0, cap=0.1, viscosity_per_s=20.0), Gains(225.0, viscosity_per_s=30.0)),
    "high": ReachGains(),
}
"""Three sets of gains, each four times as strong as the one before, with equal damping: each reaches faster, as in the
paper's figure 5."""
GENTLE = "low"
"""Key of `GAIN_SETS` for an infant that sits freely: accelerating the arms (10 % of its weight) with the 80 m/s² of the
strong gains causes a reaction force as large as its weight, and it falls over; with 5 m/s² it does not."""


class ReachController:
    """Makes all commanded hands reach for one target each, and the eyes look at one of the targets."""

    def __init__(self, model: mujoco.MjModel, data: mujoco.MjData, manifest: Manifest, gains: ReachGains | None = None):
        """Bind the controller to an infant, whose hands keep their positions until `aim` is called.

        Args:
            model: The infant and its world.
            data: Its state, which each call reads.
            manifest: Manifest of its bundle; it must have motors or muscles.
            gains: Gains of hands and eyes; None means gentle ones for an infant that sits freely, else strong ones.

        Raises:
            ControlError: If the infant has servos, or no commanded hand.
        """
        self._data, self._balance = data, Balance(model, manifest)
        self._places = ReachablePlaces(model, manifest)
        self.sits_freely = self._balance.sits_freely(data)
        """Whether the infant was upright and supported only by the ground when the controller was created."""
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
        """Set the target of each hand, shape (3,), [m]; the eyes look at the target of hand number *watched*."""
        for reach, place_m in zip(self._reaches, places_m, strict=True):
            reach.target = place_m
        for look in self._looks:
            look.target = places_m[watched % len(places_m)]

    def draw(self, generator: np.random.Generator) -> tuple[FloatArray, ...] | None:
        """Return a random reachable target for each hand, shape (3,), [m], or None if none is found."""
        return self._places.draw(self._data, generator)

    def errors(self) -> tuple[list[float], list[float]]:
        """Return the present errors of the hands, [m], and of the eyes, [rad]."""
        errors = list(self._control.errors()[self._first :])
        return errors[: len(self._reaches)], errors[len(self._reaches) :]
