"""Senses that a script passes as objects, without a record or a bundle that knows of them."""

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np
from gymnasium.spaces import Box

from mimoc.bundle.io import Bundle
from mimoc.delays.spec import DelayEntry
from mimoc.errors import KindError
from mimoc.senses.sense import IntArray, Observation, Reading
from mimoc.units import to_steps


def _delay_of(name: str, custom: Any, bundle: Bundle) -> DelayEntry:
    delay_ms = float(getattr(custom, "delay_ms", 0.0))
    try:
        to_steps(delay_ms, bundle.manifest.timestep_ms)
    except ValueError as error:
        raise KindError(f"sense '{name}': {error}") from None
    return DelayEntry(ms=delay_ms)


class CustomSense:
    """A sense made of an object of a user's own.

    The object has `space`, a Gymnasium `Box`, and is called with the simulation's `MjData` for a sample: an array of
    that shape. It can also have `bind(model, bundle)`, called whenever a model was loaded and before `space` is read;
    `delay_ms`, a whole number of physics steps (0 without it); and `close()`.
    """

    def __init__(self, name: str, custom: Any, model: mujoco.MjModel, bundle: Bundle):
        """Bind the object to a model; *name* is that of its observation."""
        if hasattr(custom, "bind"):
            custom.bind(model, bundle)
        self._custom, self._space = custom, custom.space
        self.spaces: Mapping[str, Box] = {name: self._space}
        self.layout = tuple(f"{name} {index}" for index in range(int(np.prod(self._space.shape))))
        self.bodies: IntArray = np.zeros(len(self.layout), np.intp)
        self._name = name
        self.delay = _delay_of(name, custom, bundle)

    def __call__(self, data: mujoco.MjData) -> Reading:
        """Return the sample now, an array of its own."""
        return np.array(self._custom(data), dtype=np.float64)

    def observe(self, reading: Reading) -> Observation:
        """Return a sample within its space, in the type of its space."""
        clipped = np.clip(reading, self._space.low, self._space.high).reshape(self._space.shape)
        return {self._name: clipped.astype(self._space.dtype)}

    def follow(self, model: mujoco.MjModel) -> bool:
        """Return False: it is bound anew in another scene."""
        return False

    def close(self) -> None:
        """Close the object, if it can be."""
        if hasattr(self._custom, "close"):
            self._custom.close()
