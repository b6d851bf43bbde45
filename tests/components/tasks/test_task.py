"""What a task that judges by a term remembers, changes and says."""

import copy
import pickle
from dataclasses import dataclass
from typing import Any

import gymnasium
import mujoco
import numpy as np
import pytest

from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.task import Change, Judgement, Task
from mimoc.runtime.term import Term

MODEL = """
<mujoco>
  <worldbody>
    <body name="a"><freejoint/><geom size=".1" mass="1"/></body>
    <body name="b" pos="1 0 0"><freejoint/><geom size=".1" mass="1"/></body>
  </worldbody>
</mujoco>"""


@dataclass(frozen=True)
class Falling(Term):
    """How far two bodies have fallen; what has fallen far weighs nothing."""

    bodies: np.ndarray
    far_m: float

    def __call__(self, worlds: Any, action: Any, memory: Any) -> Judgement:
        height_m = worlds.xp.take(worlds.xpos, self.bodies, axis=1)[..., 2]
        fallen_m = memory["start_m"] - worlds.xp.max(height_m, axis=-1)
        is_far = fallen_m > self.far_m
        steps = memory["steps"] + 1
        lighter = Change(is_far, lambda: worlds.xp.ones_like(height_m))
        inertia = Change(is_far, lambda: 0.5 * worlds.xp.ones_like(height_m), column=2)
        changes = {"body_gravcomp": lighter, "body_inertia": inertia}
        return Judgement({"fallen": fallen_m}, is_far, steps > 2, {"steps": steps}, changes)


class FallingTask(Task):
    """Two bodies that fall."""

    spaces = {"start_m": gymnasium.spaces.Box(0.0, 9.0, (), np.float32)}  # noqa: RUF012
    model_fields = (*(ModelField("body_gravcomp", np.array([body])) for body in (1, 2)),)
    model_fields += (ModelField("body_inertia", np.array([1, 2])),)

    def __init__(self, steps: int | None = None):
        super().__init__(steps, Falling(np.array([1, 2]), 0.05), {"start_m": 0.0, "steps": 0})

    def start(self, data: mujoco.MjData, generator: np.random.Generator) -> None:
        self.remember(start_m=data.xpos[1:, 2].max(), steps=0)


@pytest.fixture
def data() -> mujoco.MjData:
    data = mujoco.MjData(mujoco.MjModel.from_xml_string(MODEL))
    mujoco.mj_forward(data.model, data)
    return data


def judged(task: Task, data: mujoco.MjData, seconds: float = 0.0) -> Judgement:
    mujoco.mj_step(data.model, data, round(seconds / data.model.opt.timestep))
    return task.judge(data, np.zeros(0), lambda: 0.0)


def test_a_term_gives_numbers_of_one_infant_and_what_it_remembers_stays(data):
    task = FallingTask()
    task.start(data, np.random.default_rng())
    first = judged(task, data, 0.02)
    assert first.reward_terms["fallen"] == first.reward > 0.0
    assert first[1:3] == (False, False)
    assert all(type(value) is bool for value in first[1:3])
    assert task.memory == {"start_m": 0.0, "steps": 1}
    assert [judged(task, data).terminated for _ in range(2)] == [False, True]
    assert task.observe() == {"start_m": 0.0}
    assert task.observe()["start_m"].dtype == np.float32


def test_declared_rows_of_the_model_change_when_the_term_says_so(data):
    task = FallingTask()
    before = data.model.body_inertia.copy()
    judged(task, data)
    assert not data.model.body_gravcomp.any()
    judged(task, data, 0.2)
    assert data.model.body_gravcomp.tolist() == [0.0, 1.0, 1.0]
    assert data.model.body_inertia[1:, 2].tolist() == [0.5, 0.5]
    assert (data.model.body_inertia[:, :2] == before[:, :2]).all()


def test_what_is_remembered_is_the_state_which_keeps_its_form(data):
    task, other = FallingTask(), FallingTask()
    judged(task, data)
    other.state = copy.deepcopy(task.state)
    assert other.state == {"start_m": 0.0, "steps": 1}
    for wrong in ({"start_m": np.array(0.0)}, {**task.state, "steps": np.array(1.5)}, None):
        with pytest.raises(ValueError, match=r"task(\.steps)? is"):
            other.state = wrong
    assert other.state == {"start_m": 0.0, "steps": 1}


def test_a_copy_of_a_task_is_bound_to_no_data(data):
    task = FallingTask()
    judged(task, data)
    for copied in (copy.deepcopy(task), pickle.loads(pickle.dumps(task))):
        assert judged(copied, data).reward_terms == judged(task, data).reward_terms


@dataclass(frozen=True)
class Sinking(Term):
    """How far a body has sunk since the step before."""

    def __call__(self, worlds: Any, action: Any, memory: Any) -> Judgement:
        places_m = worlds.xpos[:, 1, :]
        return Judgement({"sunk": (memory["places_m"] - places_m)[:, 2]}, memory={"places_m": places_m})


def test_what_is_remembered_of_the_worlds_does_not_change_with_them(data):
    task = Task(term=Sinking(), memory={"places_m": np.zeros(3)})
    sunk_m = [judged(task, data, 0.05).reward for _ in range(3)]
    assert 0.0 < sunk_m[0] < sunk_m[1] < sunk_m[2]
