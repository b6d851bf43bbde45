"""Turning over on a device; see `mimoc.tasks.rollover`."""

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.tasks.commands import command_bounds, squared_commands
from mimoc.runtime.warp.tasks.task import DeviceTask, Judged, body_id


class DeviceRollover(DeviceTask):
    """How far an infant has turned; remembered are the side that it started on and how far it had turned before."""

    def __init__(self, infants: Sequence[InfantEnv], worlds: int):
        """Find the hip."""
        entry: Any = infants[0].manifest.task
        self._entry, self._hip, self._bounds = entry, body_id(infants[0], entry.hip), command_bounds(infants)
        self._dense = entry.reward == "dense"
        self.terms = ("turn", "effort") if self._dense else ("shaping", "success")
        numbers = (entry.goal, entry.effort_weight, entry.success_reward, entry.discount)
        self._numbers = put([numbers], wp.vec4)

    def memory(self, state: Mapping[str, Any]) -> list[float]:
        """Return whether it started on its back, and how far it has turned."""
        return [float(state["starts_on_back"]), state["turned"]]

    def judge(self, model: mjw.Model, data: mjw.Data, judged: Judged) -> None:
        """Write what the turn earns."""
        kinds = [judged.body, self._hip, int(self._dense), self._numbers, self._bounds, judged.actions, data.xmat]
        wp.launch(_judge, judged.body.shape, kinds, [judged.memory, judged.terms, judged.success, judged.terminated])


@wp.kernel(enable_backward=False)
def _judge(
    body: wp.array[int],
    hip: int,
    dense: int,
    numbers: wp.array[wp.vec4],
    bounds: wp.array2d[wp.vec2],
    actions: wp.array2d[float],
    xmat: wp.array2d[wp.mat33],
    memory: wp.array2d[float],
    terms: wp.array2d[float],
    success: wp.array[int],
    terminated: wp.array[int],
):
    world = wp.tid()
    turn = xmat[world, hip]
    share = wp.atan2(wp.sqrt(turn[0, 0] * turn[0, 0] + turn[1, 0] * turn[1, 0]), turn[2, 0]) / wp.static(np.pi)
    if memory[world, 0] == 0.0:
        share = 1.0 - share
    before = memory[world, 1]
    memory[world, 1] = share
    own = numbers[0]
    reached = share >= own[0]
    if reached:
        success[world] = 1
    if dense == 1:
        terms[world, 0] = share
        terms[world, 1] = -own[1] * squared_commands(actions, bounds, body[world], world)
    elif reached:
        terms[world, 0] = -before
        terms[world, 1] = own[2]
        terminated[world] = 1
    else:
        terms[world, 0] = own[3] * share - before
