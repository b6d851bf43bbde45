"""Reaching on a device; see `mimoc.tasks.reach`."""

from collections.abc import Mapping, Sequence
from typing import Any

import mujoco_warp as mjw
import numpy as np
import warp as wp

from mimoc.mujoco_layout import LOCK_ANGLE
from mimoc.runtime.env import InfantEnv
from mimoc.runtime.warp.arrays import flat, put
from mimoc.runtime.warp.tasks.task import DeviceTask, Judged, body_id
from mimoc.tasks.reach.run import STILL_M


class DeviceReach(DeviceTask):
    """A ball within reach; remembered is where it was hung, three numbers."""

    terms = ("distance", "touch")

    def __init__(self, infants: Sequence[InfantEnv], worlds: int):
        """Find hand, ball, head and eyes."""
        entries: list[Any] = [infant.manifest.task for infant in infants]
        first, model = entries[0], infants[0].model
        self._hand, self._ball = body_id(infants[0], first.effector), body_id(infants[0], first.ball.body)
        self._moved_m, self._reward = (
            put([getattr(e, name) for e in entries]) for name in ("moved_m", "success_reward")
        )
        joints = [model.joint(gaze.joint) for gaze in first.gaze]
        lock_of = {lock.joint: lock.equality for lock in infants[0].manifest.constraints.locks}
        locks = [model.equality(lock_of[gaze.joint]).id for gaze in first.gaze]
        self._locks = put(locks, wp.int32)
        self._joints = put([joint.id for joint in joints], wp.int32)
        self._angles = put([joint.qposadr[0] for joint in joints], wp.int32)
        self._lookers = put([body_id(infants[0], gaze.looker) for gaze in first.gaze], wp.int32)
        ranges = np.array([[each.model.joint(gaze.joint).range for gaze in first.gaze] for each in infants])
        self._ranges = put(ranges.reshape(len(infants), len(joints), 2), wp.vec2)
        self._count = len(joints)

    def memory(self, state: Mapping[str, Any]) -> list[float]:
        """Return where the ball was hung."""
        return state["start_m"].tolist()

    def judge(self, model: mjw.Model, data: mjw.Data, judged: Judged) -> None:
        """Write what the distance costs and a touch earns; head and eyes follow a ball that moves."""
        places = [judged.body, self._hand, self._ball, self._moved_m, self._reward, data.xpos, judged.memory]
        wp.launch(_judge, judged.body.shape, places, [judged.terms, judged.success, judged.terminated])
        if self._count:
            locked = flat(model.eq_data)
            looks = [self._joints, self._angles, self._lookers, self._locks, self._ranges]
            fields = [data.qpos, data.xpos, data.xmat, data.xaxis]
            stride = locked.shape[1] // model.eq_data.shape[1]
            inputs = [judged.body, self._ball, judged.memory, *looks, stride, *fields]
            wp.launch(_follow, (judged.body.shape[0], self._count), inputs, [locked])


@wp.kernel(enable_backward=False)
def _judge(
    body: wp.array[int],
    hand: int,
    ball: int,
    moved_m: wp.array[float],
    reward: wp.array[float],
    xpos: wp.array2d[wp.vec3],
    memory: wp.array2d[float],
    terms: wp.array2d[float],
    success: wp.array[int],
    terminated: wp.array[int],
):
    world = wp.tid()
    start = wp.vec3(memory[world, 0], memory[world, 1], memory[world, 2])
    terms[world, 0] = -wp.length(xpos[world, ball] - xpos[world, hand])
    if wp.length(xpos[world, ball] - start) > moved_m[body[world]]:
        terms[world, 1] = reward[body[world]]
        success[world] = 1
        terminated[world] = 1


@wp.kernel(enable_backward=False)
def _follow(
    body: wp.array[int],
    ball: int,
    memory: wp.array2d[float],
    joints: wp.array[int],
    angles: wp.array[int],
    lookers: wp.array[int],
    locks: wp.array[int],
    ranges: wp.array2d[wp.vec2],
    stride: int,
    qpos: wp.array2d[float],
    xpos: wp.array2d[wp.vec3],
    xmat: wp.array2d[wp.mat33],
    xaxis: wp.array2d[wp.vec3],
    locked: wp.array2d[float],
):
    """Turn a joint by the angle that brings its looker's x axis nearest to the ball; see `Gaze`."""
    world, index = wp.tid()
    target = xpos[world, ball]
    start = wp.vec3(memory[world, 0], memory[world, 1], memory[world, 2])
    if wp.length(target - start) > wp.static(STILL_M):
        axis = xaxis[world, joints[index]]
        looker = lookers[index]
        forward = xmat[world, looker] @ wp.vec3(1.0, 0.0, 0.0)
        towards = target - xpos[world, looker]
        across = wp.dot(forward, towards) - wp.dot(axis, forward) * wp.dot(axis, towards)
        turned = qpos[world, angles[index]] + wp.atan2(wp.dot(axis, wp.cross(forward, towards)), across)
        limits = ranges[body[world], index]
        locked[world, locks[index] * stride + wp.static(LOCK_ANGLE)] = wp.clamp(turned, limits[0], limits[1])
