"""What a task must say of a control step, and how it is told when it does not."""

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from gymnasium.spaces import Box
from support.worlds import ANNA, BEN, world

import mimoc
from mimoc import Judgement
from mimoc.base.errors import KindError
from mimoc.plugin import Change
from mimoc.runtime.task import check_term_judgement

FINITE = "expected a finite number, or a mimoc.Judgement of such by name"


@pytest.fixture(scope="module")
def opened() -> mimoc.Bundle:
    """Return an infant, built once."""
    return mimoc.build(mimoc.InfantSpec(mimoc=1, name="a", age_months=9, senses={"vestibular": {}}))


class Says:
    """A task that says what it was given, or in each step the next of some."""

    def __init__(self, *judgements: Any):
        self.judgements = list(judgements)

    def judge(self, data: Any, action: Any, effort: Any) -> Any:
        return self.judgements.pop(0) if len(self.judgements) > 1 else self.judgements[0]


def stepped(env: Any, steps: int = 1) -> Any:
    """Return what the last of some steps gives."""
    env.reset(seed=0)
    given = None
    for _ in range(steps):
        given = env.step(env.action_space.sample())
    env.close()
    return given


@pytest.mark.parametrize(
    ("judgement", "told"),
    [
        (float("nan"), f"the term 'reward' of its reward is nan; {FINITE}"),
        (np.inf, f"the term 'reward' of its reward is inf; {FINITE}"),
        (None, f"the term 'reward' of its reward is None; {FINITE}"),
        ("1.0", f"the term 'reward' of its reward is '1.0'; {FINITE}"),
        (1j, f"the term 'reward' of its reward is 1j; {FINITE}"),
        ((1.0, False), f"the term 'reward' of its reward is (1.0, False); {FINITE}"),
        (np.ones(1), f"the term 'reward' of its reward is an array of float64, shape (1,); {FINITE}"),
        (Judgement({"a": 1.0, "b": np.nan}), f"the term 'b' of its reward is nan; {FINITE}"),
        (Judgement({"a": "x"}), f"the term 'a' of its reward is 'x'; {FINITE}"),
        (Judgement({"a": np.ones(2)}), f"the term 'a' of its reward is an array of float64, shape (2,); {FINITE}"),
        (Judgement({}, success="no"), "'success' of its judgement is 'no'; expected True or False"),
        (Judgement({}, terminated=None), "'terminated' of its judgement is None; expected True or False"),
    ],
    ids=str,
)
def test_a_first_judgement_that_is_none_is_an_error_with_the_class(opened, judgement, told):
    with pytest.raises(KindError) as raised:
        stepped(mimoc.make(opened, task=Says(judgement)))
    assert str(raised.value) == f"task {__name__}:Says: {told}"


@pytest.mark.parametrize("judgement", [2, 2.0, np.float32(2), np.array(2.0), Judgement({"a": np.float64(2.0)})])
def test_numbers_of_any_library_are_rewards(opened, judgement):
    reward = stepped(mimoc.make(opened, task=Says(judgement)))[1]
    assert (type(reward), reward) == (float, 2.0)


def test_a_reward_that_becomes_nan_later_is_an_error_in_that_step(opened):
    env = mimoc.make(opened, task=Says(1.0, Judgement({"a": 1.0, "b": 2.0}), Judgement({"b": np.nan})))
    env.reset(seed=0)
    assert [env.step(env.action_space.sample())[1] for _ in range(2)] == [1.0, 3.0]
    with pytest.raises(KindError, match="the term 'b' of its reward is nan"):
        env.step(env.action_space.sample())
    env.close()


def test_worlds_and_batches_hold_tasks_to_the_same(opened):
    for envs in (
        mimoc.make_vec(opened, 2, task=Says(np.nan)),
        mimoc.make_parallel(world(anna=ANNA, ben=BEN), tasks={"ben": Says(np.nan)}),
    ):
        envs.reset(seed=0)
        is_world = hasattr(envs, "agents")
        actions = (
            {name: envs.action_space(name).sample() for name in envs.agents} if is_world else envs.action_space.sample()
        )
        with pytest.raises(KindError, match="Says: the term 'reward' of its reward is nan"):
            envs.step(actions)
        envs.close()


class Nameless(mimoc.Task):
    """A task whose author misspelt `judge`."""

    def jugde(self, data: Any, action: Any, effort: Any) -> float:
        return 1.0


@pytest.mark.parametrize("task", [Nameless(), mimoc.Task(steps=5)])
def test_a_task_that_cannot_judge_is_an_error_at_the_first_step(opened, task):
    name = type(task).__name__
    with pytest.raises(KindError, match=rf":{name} has neither a method 'judge' of its own nor a 'term'; override"):
        stepped(mimoc.make(opened, task=task))


@dataclass(frozen=True)
class Rule(mimoc.Term):
    """A term that is a function of the heights of the first body."""

    rule: Callable[[Any], Any]

    def __call__(self, worlds: Any, action: Any, memory: Any) -> Any:
        return self.rule(worlds.xpos[:, 1, 2])


RULES = [
    (lambda height: height, r"its judgement is an array of float64, shape \(1,\); expected a mimoc.Judgement"),
    (lambda height: None, "its judgement is None"),
    (lambda height: Judgement({"h": 1.0}), r"the term 'h' of its reward is 1.0; expected an array of shape \(1,\)"),
    (lambda height: Judgement({"h": height[None]}), r"is an array of float64, shape \(1, 1\)"),
    (lambda height: Judgement({}, success=height[None] > 0), "'success' of its judgement is an array of bool"),
    (lambda height: Judgement({}, memory={"m": height}), "'m' of its memory is not what its task remembers"),
    (lambda height: Judgement({}, memory={"kept": height[None]}), r"'kept' of its memory is .*\(1, 1\); expected"),
    (lambda height: Judgement({}, changes={"body_mass": Change(height > 0, lambda: height)}), "changes 'body_mass'"),
]


@pytest.mark.parametrize(("rule", "told"), RULES, ids=[told[:24] for _, told in RULES])
def test_a_term_says_one_thing_of_each_infant(opened, rule, told):
    with pytest.raises(KindError, match=rf"the term .*test_judgement:Rule: .*{told}"):
        stepped(mimoc.make(opened, task=mimoc.Task(term=Rule(rule), memory={"kept": 0.0})))


def test_shapes_of_many_are_checked_as_on_a_device():
    """What is looked at are shapes, whatever the library."""
    three = Judgement({"h": np.zeros(3)}, success=np.zeros(3, bool), memory={"kept": np.zeros((3, 2))})
    check_term_judgement(three, None, 3, {"kept": np.ones((3, 2))}, ())
    with pytest.raises(KindError, match=r"the term 'h' of its reward .*; expected an array of shape \(4,\)"):
        check_term_judgement(three, None, 4, {"kept": np.ones((3, 2))}, ())


class Watched(mimoc.Task):
    """A task with a part of the observation."""

    spaces = {"goal": Box(0.0, 1.0, (1,), np.float32)}  # noqa: RUF012

    def __init__(self, observed: Any):
        super().__init__()
        self.observed = observed

    def judge(self, data: Any, action: Any, effort: Any) -> Any:
        return 1.0

    def observe(self) -> Any:
        return copy.copy(self.observed)


@pytest.mark.parametrize(
    ("observed", "told"),
    [
        (None, r"observe\(\) returns None; expected goal"),
        ({}, r"observe\(\) returns nothing; expected goal"),
        ({"gaol": np.zeros(1, np.float32)}, r"observe\(\) returns gaol; expected goal"),
        ({"goal": np.zeros(1)}, r"'goal' in its observation is an array of float64, shape \(1,\); expected .*float32"),
        ({"goal": np.zeros(2, np.float32)}, r"'goal' in its observation is an array of float32, shape \(2,\)"),
        ({"goal": np.float32([np.nan])}, "'goal' in its observation has a NaN"),
    ],
)
def test_what_a_task_observes_is_as_its_spaces_say(opened, observed, told):
    with pytest.raises(KindError, match=rf"^task .*test_judgement:Watched: {told}"):
        mimoc.make(opened, task=Watched(observed))


@pytest.mark.parametrize("steps", ["10", 0, -5, 2.5])
def test_episodes_are_whole_numbers_of_steps(opened, steps):
    task = Says(1.0)
    task.steps = steps
    with pytest.raises(KindError, match=rf"Says: its 'steps' are {steps!r}; expected a whole number from 1"):
        mimoc.make(opened, task=task)
