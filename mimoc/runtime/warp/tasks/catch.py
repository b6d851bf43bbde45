"""Catching on a device; see `mimoc.tasks.catch`."""

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp

from mimoc.errors import MimocError
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.contacts import Contacts, contacts_of, presses
from mimoc.runtime.warp.tasks.task import DeviceTask, Judged, body_id
from mimoc.senses.sense import FloatArray, IntArray
from mimoc.tasks.catch.run import BALL, HAND, owners_of_geoms


class DeviceCatch(DeviceTask):
    """A ball over the palm; remembered is for how many steps it has been held.

    Its size and mass are fields of the model that each start sets.
    """

    terms = ("contact", "effort", "catch", "loss")

    def __init__(self, infants: Sequence[InfantEnv], worlds: int):
        """Find palm, ball and actuators."""
        entries: list[Any] = [infant.manifest.task for infant in infants]
        self._palm, self._ball = (body_id(infants[0], name) for name in (entries[0].palm, entries[0].ball.body))
        self._owners = put(owners_of_geoms(entries[0], infants[0].model), wp.int32)
        self._palms_m, self._lost_m = put([each.palm_m for each in entries], wp.vec3), put([e.lost_m for e in entries])
        first = entries[0]
        self._held_steps, self._rewards = first.held_steps, (first.contact_reward, first.success_reward)
        costs = [_cost(infant, entry.effort_weight) for infant, entry in zip(infants, entries, strict=True)]
        self._places, self._by_activation = put(costs[0][0], wp.int32), _by_activation(infants[0])
        self._weights = put([weights for _, weights in costs])
        self._touching = wp.zeros(worlds, dtype=int)

    def memory(self, state: Mapping[str, Any]) -> list[float]:
        """Return for how many steps the ball has been held."""
        return [float(state["held"])]

    def judge(self, model: mjw.Model, data: mjw.Data, judged: Judged) -> None:
        """Write what contact earns and effort costs, and what holding or losing the ball does."""
        self._touching.zero_()
        wp.launch(_touch, data.naconmax, [contacts_of(data), self._owners], [self._touching])
        drive = data.act if self._by_activation else data.actuator_force
        numbers = [float(self._held_steps), *self._rewards]
        tables = [judged.body, self._palms_m, self._lost_m, self._places, self._weights]
        fields = [self._palm, self._ball, data.xpos, data.xmat, drive, self._touching]
        written = [judged.memory, judged.terms, judged.success, judged.terminated]
        wp.launch(_judge, judged.body.shape, [*numbers, *tables, *fields], written)


def _by_activation(infant: InfantEnv) -> bool:
    return infant.manifest.actuation.model == "muscle"


def _cost(infant: InfantEnv, weight: float) -> tuple[IntArray, FloatArray]:
    """Return where the effort of each actuator is read from, and what the square of that number costs.

    Raises:
        MimocError: If the effort of this actuation model is not known here.
    """
    ids, largest_nm = infant.actuation.actuators, np.abs(infant.actuation.limits_nm).max(axis=1)
    model = infant.manifest.actuation.model
    if model not in ("torque", "muscle", "position"):
        raise MimocError(f"the effort of actuation model '{model}' is not there on this device; leave out device")
    share = largest_nm / max(len(ids) * largest_nm.sum(), 1e-12)
    if model == "position":
        share = np.divide(share, largest_nm**2, out=np.zeros(len(ids)), where=largest_nm > 0)
    return infant.model.actuator_actadr[ids] if model == "muscle" else ids, weight * share


@wp.kernel(enable_backward=False)
def _touch(contacts: Contacts, owners: wp.array[int], touching: wp.array[int]):
    index = wp.tid()
    if presses(contacts, index):
        pair = owners[contacts.geoms[index][0]] + owners[contacts.geoms[index][1]]
        if pair == wp.static(HAND + BALL):
            touching[contacts.world[index]] = 1


@wp.kernel(enable_backward=False)
def _judge(
    held_steps: float,
    contact_reward: float,
    success_reward: float,
    body: wp.array[int],
    palms_m: wp.array[wp.vec3],
    lost_m: wp.array[float],
    places: wp.array[int],
    weights: wp.array2d[float],
    palm: int,
    ball: int,
    xpos: wp.array2d[wp.vec3],
    xmat: wp.array2d[wp.mat33],
    drive: wp.array2d[float],
    touching: wp.array[int],
    memory: wp.array2d[float],
    terms: wp.array2d[float],
    success: wp.array[int],
    terminated: wp.array[int],
):
    world = wp.tid()
    mine = body[world]
    effort = float(0.0)
    for number in range(places.shape[0]):
        effort += weights[mine, number] * drive[world, places[number]] * drive[world, places[number]]
    terms[world, 1] = -effort
    held = float(0.0)
    if touching[world] == 1:
        held = memory[world, 0] + 1.0
        terms[world, 0] = contact_reward
    memory[world, 0] = held
    away = xpos[world, ball] - xpos[world, palm] - xmat[world, palm] @ palms_m[mine]
    if held >= held_steps:
        terms[world, 2] = success_reward
        success[world] = 1
        terminated[world] = 1
    elif away[2] < -lost_m[mine] or wp.sqrt(away[0] * away[0] + away[1] * away[1]) > lost_m[mine]:
        terms[world, 3] = -success_reward
        terminated[world] = 1
