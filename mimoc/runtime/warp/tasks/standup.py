"""Standing up on a device; see `mimoc.tasks.standup`."""

from collections.abc import Sequence
from typing import Any

import mujoco_warp as mjw
import warp as wp

from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import put
from mimoc.runtime.warp.tasks.commands import command_bounds, squared_commands
from mimoc.runtime.warp.tasks.task import DeviceTask, Judged, body_id


class DeviceStandup(DeviceTask):
    """The height of the head, less what the commands cost."""

    terms = ("height", "effort")

    def __init__(self, infants: Sequence[InfantEnv], worlds: int):
        """Find the head."""
        entries: list[Any] = [infant.manifest.task for infant in infants]
        self._head, self._bounds = body_id(infants[0], entries[0].head), command_bounds(infants)
        self._heights = put([(each.base_m, each.success_m, each.effort_weight) for each in entries], wp.vec3)

    def judge(self, model: mjw.Model, data: mjw.Data, judged: Judged) -> None:
        """Write what the height earns and the commands cost."""
        inputs = [judged.body, self._head, self._heights, self._bounds, judged.actions, data.xpos]
        wp.launch(_judge, judged.body.shape, inputs, [judged.terms, judged.success])


@wp.kernel(enable_backward=False)
def _judge(
    body: wp.array[int],
    head: int,
    heights: wp.array[wp.vec3],
    bounds: wp.array2d[wp.vec2],
    actions: wp.array2d[float],
    xpos: wp.array2d[wp.vec3],
    terms: wp.array2d[float],
    success: wp.array[int],
):
    world = wp.tid()
    own = heights[body[world]]
    height = xpos[world, head][2]
    terms[world, 0] = height - own[0]
    terms[world, 1] = -own[2] * squared_commands(actions, bounds, body[world], world)
    if height >= own[1]:
        success[world] = 1
