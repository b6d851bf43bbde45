"""The physics of many infants."""

import os

import mujoco
import numpy as np
import pytest

from mimoc.runtime.batch.physics import ThreadedPhysics, usable_threads

PENDULUM = """
<mujoco>
  <worldbody>
    <body>
      <joint name="hinge" type="hinge" axis="0 1 0"/>
      <geom type="capsule" fromto="0 0 0 0 0 -{length}" size="0.02"/>
    </body>
  </worldbody>
</mujoco>
"""


@pytest.fixture
def pendulums() -> list[tuple[mujoco.MjModel, mujoco.MjData]]:
    models = [mujoco.MjModel.from_xml_string(PENDULUM.format(length=0.1 * (i + 1))) for i in range(9)]
    datas = [mujoco.MjData(model) for model in models]
    for data in datas:
        data.qpos[0] = 1.0
    return list(zip(models, datas, strict=True))


@pytest.mark.parametrize("threads", [1, 2, 5])
def test_each_group_is_done_when_it_is_yielded(pendulums, threads):
    physics = ThreadedPhysics(*zip(*pendulums, strict=True), threads)
    groups = [[3, 1], [0, 2, 4], [8]]
    alone = [mujoco.MjData(model) for model, _ in pendulums]
    for (model, _), data in zip(pendulums, alone, strict=True):
        data.qpos[0] = 1.0
        mujoco.mj_step(model, data, 7)
    seen = []
    for group in physics.step(groups, 7):
        assert np.array_equal(physics.array("qpos", group), [alone[index].qpos for index in group])
        seen.append(list(group))
    assert seen == groups
    assert [index for index, data in enumerate(physics.datas) if data.time == 0] == [5, 6, 7]
    physics.close()


def test_fields_come_in_the_order_that_is_asked_for(pendulums):
    physics = ThreadedPhysics(*zip(*pendulums, strict=True), 1)
    for index, data in enumerate(physics.datas):
        data.qpos[0] = index
    order = [2, 0, 1, 8, 7, 6, 5, 4, 3]
    assert physics.array("qpos", order).ravel().tolist() == order


def test_a_model_can_be_put_in_place_of_another(pendulums):
    physics = ThreadedPhysics(*zip(*pendulums, strict=True), 1)
    physics.array("qvel", [0])
    model, _ = pendulums[8]
    data = mujoco.MjData(model)
    data.qpos[0] = 1.0
    physics.replace(0, model, data)
    for _ in physics.step([[0, 8]], 3):
        pass
    assert physics.array("qvel", [0]) == physics.array("qvel", [8])


def test_one_that_breaks_down_is_told_from_the_others(pendulums):
    physics = ThreadedPhysics(*zip(*pendulums, strict=True), 2)
    physics.datas[4].qvel[:] = 1e12
    for _ in physics.step([range(9)], 2):
        pass
    assert physics.are_unstable() == [index == 4 for index in range(9)]
    physics.close()


def test_as_many_threads_are_used_as_may_be(pendulums, monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda pid: {0, 3, 5}, raising=False)
    assert usable_threads() == 3
    physics = ThreadedPhysics(*zip(*pendulums, strict=True))
    assert physics.threads == 3
    physics.close()


def test_nobody_steps_an_infant_behind_the_back_of_a_caller_that_stops(pendulums):
    physics = ThreadedPhysics(*zip(*pendulums, strict=True), 3)
    stepped = physics.step([[0, 1, 2], [3, 4, 5], [6, 7, 8]], 50)
    assert next(stepped) == [0, 1, 2]
    stepped.close()
    times = [data.time for data in physics.datas]
    physics.close()
    assert [data.time for data in physics.datas] == times
