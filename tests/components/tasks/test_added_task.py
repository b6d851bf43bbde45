"""A task that is added is a record, a spec, an entry, `build` and `bind`: nothing else knows of it."""

import json
from dataclasses import dataclass
from typing import Literal

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import mimoc
from mimoc.compiler.explain import explain
from mimoc.compiler.task_setup import TaskSetup
from mimoc.runtime.actuation import command_range
from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.task import Judgement, SquaredCommands, Task
from mimoc.runtime.term import Term
from mimoc.schema.infant import read_spec
from mimoc.schema.kinds import TaskKind
from mimoc.schema.source import parse
from mimoc.schema.task import TaskEntry, TaskSpec


class LiftSpec(TaskSpec):
    """Lift a body; gravity is another in each episode."""

    kind: Literal["lift"]
    """Which task this is."""
    body: str = "head"
    """What is to be lifted."""


class LiftEntry(TaskEntry):
    """Lift a body."""

    kind: Literal["lift"] = "lift"
    """Which task this is."""
    body: str
    """What is to be lifted."""
    success_m: float = 0.3
    """Height of success."""


@dataclass(frozen=True)
class Height(Term):
    """The reward is the height of a body, less what the commands cost."""

    body: int
    success_m: float
    cost: SquaredCommands

    def __call__(self, worlds, action, memory):
        height_m = worlds.xpos[:, self.body, 2]
        terms = {"height": height_m, "effort": -self.cost(worlds, action)}
        return Judgement(terms, success=height_m > self.success_m)


class Lift(Task):
    """Gravity is another in each episode."""

    def __init__(self, entry, model, bundle):
        self._model, self._body = model, model.body(entry.body).id
        cost = SquaredCommands(*command_range(bundle.manifest.actuation))
        super().__init__(entry.steps, Height(self._body, entry.success_m, cost))

    @property
    def model_fields(self):
        return (ModelField("body_gravcomp", np.array([self._body])),)

    def start(self, data, generator):
        self._model.body_gravcomp[self._body] = generator.uniform()


LIFT = TaskKind(
    name="lift",
    spec=LiftSpec,
    entry=LiftEntry,
    build=lambda spec, tree: TaskSetup(LiftEntry(steps=spec.steps or 4, body=spec.body)),
    run=Lift,
    scenes=("flat",),
    poses=None,
    step_ms=20.0,
)
TINY = {"n_steps": 32, "batch_size": 64, "n_epochs": 1, "width": 8, "layers": 1}
SPEC = "mimoc: 1\nname: x\nage_months: 6\nsenses: {proprioception: {}}\ntask: "


@pytest.fixture
def lift(registered):
    with registered(LIFT):
        yield


@pytest.fixture
def bundle(lift):
    return mimoc.build(read_spec(parse(f"{SPEC}{{kind: lift}}", "spec.yaml")))


def test_it_is_built_run_and_checked(bundle):
    assert (bundle.manifest.task.kind, bundle.manifest.step_ms) == ("lift", 20.0)
    env = mimoc.InfantEnv(bundle)
    check_env(env, skip_render_check=True)
    env.reset(seed=0)
    ends = [env.step(env.action_space.low) for _ in range(4)]
    assert [truncated for *_, truncated, _ in ends] == [False, False, False, True]
    assert ends[0][1] == pytest.approx(sum(ends[0][4]["reward_terms"].values()))
    assert ends[0][4]["reward_terms"]["effort"] == pytest.approx(-env.action_space.shape[0])


def test_what_it_changes_in_the_model_is_part_of_a_state(bundle):
    first, other = mimoc.InfantEnv(bundle), mimoc.InfantEnv(bundle)
    first.reset(seed=1)
    other.reset(seed=2)
    head = first.model.body("head").id
    assert first.model.body_gravcomp[head] != other.model.body_gravcomp[head]
    other.set_state(first.get_state())
    assert first.model.body_gravcomp[head] == other.model.body_gravcomp[head]


def test_its_numbers_are_explained(bundle):
    assert "Height of success." in explain(bundle, "task.lift.success_m").lines
    assert json.loads(bundle.files["manifest.json"])["plugins"] == {"tasks.lift": ""}


@pytest.mark.parametrize(
    ("task", "problem"),
    [
        ("{kind: lifd}", "task.kind: 'lifd' is not a choice; did you mean 'lift'"),
        ("{kind: lift, hand: left}", "task.hand: unknown key of 'lift'; remove it"),
        ("{kind: reach, body: head}", "task.body: unknown key of 'reach'; remove it (it belongs to lift)"),
        ("{kind: lift}\nscene: {kind: crib}", "task 'lift' requires scene.kind: flat"),
    ],
)
def test_the_spec_language_knows_it(lift, task, problem):
    with pytest.raises(mimoc.MimocError) as error:
        read_spec(parse(SPEC + task, "spec.yaml"))
    assert problem in str(error.value)


@pytest.mark.extras
def test_a_policy_is_trained_for_it(bundle, tmp_path):
    options = {"steps": 64, "envs": 2, "checkpoint_every": 64, "hyper": TINY, "processes": False}
    training = mimoc.train(bundle, tmp_path / "run", **options)
    (episode,) = mimoc.evaluate(mimoc.make(bundle), mimoc.load_policy(training.policy), episodes=1)
    assert episode.steps == 4


def test_gymnasium_opens_its_bundle(bundle):
    env = gymnasium.make("mimoc/Infant-v0", bundle=bundle)
    observation, _ = env.reset(seed=0)
    assert observation in env.observation_space
    assert np.isfinite(env.step(env.action_space.sample())[1])
