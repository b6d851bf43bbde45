"""What all tasks on a device have in common."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import mujoco
import mujoco_warp as mjw
import warp as wp

from mimoc.runtime.env import InfantEnv


@dataclass(frozen=True, slots=True)
class Judged:
    """What tasks read and write, of all worlds."""

    body: wp.array
    """Which body lives in each world, shape (worlds,)."""
    actions: wp.array
    """Of the present control step, shape (worlds, n)."""
    memory: wp.array
    """What the task remembers within an episode, shape (worlds, m)."""
    terms: wp.array
    """Terms of the reward, shape (worlds, terms)."""
    success: wp.array
    """Whether the goal is reached, shape (worlds,)."""
    terminated: wp.array
    """Whether the episode ends, shape (worlds,)."""


class DeviceTask:
    """The task of all infants; by itself, a world without a goal."""

    terms: tuple[str, ...] = ()
    """Names of the terms of the reward."""
    goal = 0
    """How many numbers the observation `goal` has, if there is one."""

    def __init__(self, infants: Sequence[InfantEnv], worlds: int):
        """Find everything in the models of the different bodies, for some number of worlds."""

    def memory(self, state: Mapping[str, Any]) -> list[float]:
        """Return what it remembers from the state of the same task on the CPU."""
        return []

    def judge(self, model: mjw.Model, data: mjw.Data, judged: Judged) -> None:
        """Write terms, success and terminated, which are all zero before."""

    def observe(self, memory: wp.array, goal: wp.array) -> None:
        """Write the observation `goal`, shape (worlds, goal)."""


def body_id(infant: InfantEnv, name: str) -> int:
    """Return the id of a body."""
    return mujoco.mj_name2id(infant.model, mujoco.mjtObj.mjOBJ_BODY, name)
