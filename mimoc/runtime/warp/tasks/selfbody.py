"""Touching oneself on a device; see `mimoc.tasks.selfbody`."""

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.contacts import Contacts, contacts_of, presses
from mimoc.runtime.warp.tasks.task import DeviceTask, Judged, body_id
from mimoc.tasks.selfbody.run import EFFECTOR, parts_of_geoms


class DeviceSelfbody(DeviceTask):
    """A part of the body to be touched; remembered is which."""

    terms = ("touch", "distance", "idle")

    def __init__(self, infants: Sequence[InfantEnv], worlds: int):
        """Find the hand and all parts."""
        entry: Any = infants[0].manifest.task
        self.goal, self._entry = len(entry.targets), entry
        self._fingers = body_id(infants[0], entry.fingers)
        self._parts = put(np.asarray(parts_of_geoms(entry, infants[0].model)), wp.int32)
        self._touched = wp.zeros((worlds, self.goal), dtype=int)

    def memory(self, state: Mapping[str, Any]) -> list[float]:
        """Return what is to be touched."""
        return [float(state["target"])]

    def judge(self, model: mjw.Model, data: mjw.Data, judged: Judged) -> None:
        """Write what is earned by what the hand touches."""
        self._touched.zero_()
        wp.launch(_touch, data.naconmax, [contacts_of(data), self._parts], [self._touched])
        entry = self._entry
        rewards = [entry.success_reward, entry.idle_reward]
        places = [self._fingers, self._parts, data.xpos, data.geom_xpos, judged.memory, self._touched]
        written = [judged.terms, judged.success, judged.terminated]
        wp.launch(_judge, judged.body.shape, [*rewards, *places], written)

    def observe(self, memory: wp.array, goal: wp.array) -> None:
        """Write 1 for the part that is wanted, 0 for all others."""
        wp.launch(_show, goal.shape, [memory], [goal])


@wp.kernel(enable_backward=False)
def _touch(contacts: Contacts, parts: wp.array[int], touched: wp.array2d[int]):
    index = wp.tid()
    if presses(contacts, index):
        first = parts[contacts.geoms[index][0]]
        second = parts[contacts.geoms[index][1]]
        if wp.min(first, second) == wp.static(EFFECTOR) and wp.max(first, second) >= 0:
            touched[contacts.world[index], wp.max(first, second)] = 1


@wp.kernel(enable_backward=False)
def _judge(
    reward: float,
    idle: float,
    fingers: int,
    parts: wp.array[int],
    xpos: wp.array2d[wp.vec3],
    geom_xpos: wp.array2d[wp.vec3],
    memory: wp.array2d[float],
    touched: wp.array2d[int],
    terms: wp.array2d[float],
    success: wp.array[int],
    terminated: wp.array[int],
):
    world = wp.tid()
    target = int(memory[world, 0])
    found = int(0)
    for part in range(touched.shape[1]):
        found += touched[world, part]
    if touched[world, target] == 1:
        terms[world, 0] = reward
        success[world] = 1
        terminated[world] = 1
    elif found > 0:
        least = float(1.0e30)
        for geom in range(parts.shape[0]):
            if parts[geom] == target:
                least = wp.min(least, wp.length(geom_xpos[world, geom] - xpos[world, fingers]))
        terms[world, 1] = -least
    else:
        terms[world, 2] = idle


@wp.kernel(enable_backward=False)
def _show(memory: wp.array2d[float], goal: wp.array2d[float]):
    world, part = wp.tid()
    goal[world, part] = wp.where(int(memory[world, 0]) == part, 1.0, 0.0)
