"""Senses that are terms, on a device."""

from collections.abc import Sequence
from typing import Any

import mujoco_warp as mjw
import warp as wp

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.term import stack_terms
from mimoc.runtime.warp.device_worlds import device_worlds, put_on


class TermReader:
    """Reads one sense of all infants."""

    def __init__(self, name: str, infants: Sequence[InfantEnv], body_of_world: wp.array):
        """Stack the terms of some different bodies, by the body that lives in each world."""
        senses: list[Any] = [infants[body].senses[name] for body in body_of_world.numpy()]
        self._term = stack_terms([sense.term for sense in senses], put_on(body_of_world.device))

    def __call__(self, model: mjw.Model, data: mjw.Data, sample: wp.array) -> None:
        """Write what is sensed now, shape (worlds, n)."""
        wp.to_torch(sample).copy_(self._term(device_worlds(data)))
