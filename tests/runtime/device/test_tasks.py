"""A task from outside that is a term runs on one infant, on many and on a device, from one definition."""

import copy
from dataclasses import dataclass
from typing import Any, Literal

import gymnasium
import numpy as np
import pytest
from support.devices import SITTING, infant, random_actions, spec, still

import mimoc
from mimoc.base.errors import KindError
from mimoc.compiler.task_setup import TaskSetup
from mimoc.runtime.actuation import command_range
from mimoc.runtime.device.signals import DeviceError
from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.task import Change, Judgement, SquaredCommands, Task
from mimoc.runtime.term import Term
from mimoc.schema.kinds import TaskKind
from mimoc.schema.task import TaskEntry, TaskSpec

STEPS = 6


class HoldSpec(TaskSpec):
    """Hold the head at a height, which is drawn for each episode and observed."""

    kind: Literal["hold"]


class HoldEntry(TaskEntry):
    """Hold the head at a height."""

    kind: Literal["hold"] = "hold"
    steps: int | None = None


@dataclass(frozen=True)
class Hold(Term):
    """The error of the height costs; the head gets lighter as long as it is too low."""

    head: int
    length_m: float
    weight: float
    cost: SquaredCommands

    def __call__(self, worlds: Any, action: Any, memory: Any) -> Judgement:
        error = worlds.xpos[:, self.head, 2] / self.length_m - memory["height"][:, 0]
        terms = {"error": -worlds.xp.abs(error), "effort": -self.weight * self.cost(worlds, action)}
        steps = memory["steps"] + 1
        lighter = Change(error < 0.0, lambda: worlds.xp.abs(error)[:, None])
        remembered = {"steps": steps, "was_low": error < 0.0}
        return Judgement(terms, error > 0.0, steps >= STEPS - 1, remembered, {"body_gravcomp": lighter})


class HoldTask(Task):
    """A height to hold the head at."""

    spaces = {"height": gymnasium.spaces.Box(0.0, 1.0, (1,), np.float32)}  # noqa: RUF012

    def bind(self, model: Any, bundle: Any) -> None:
        self._model, self.head = model, model.body(bundle.manifest.anatomy.head).id
        cost = SquaredCommands(*command_range(bundle.manifest.actuation))
        self.term = Hold(self.head, bundle.manifest.child.length_cm / 100, 0.01, cost)

    @property
    def model_fields(self) -> Any:
        return (ModelField("body_gravcomp", np.array([self.head])),)

    def start(self, data: Any, generator: Any) -> None:
        self._model.body_gravcomp[self.head] = 0.1
        self.remember(height=np.float32([generator.uniform(0.3, 0.6)]), steps=0, was_low=False)


def bind(entry: HoldEntry, model: Any, bundle: Any) -> HoldTask:
    task = HoldTask(entry.steps)
    task.bind(model, bundle)
    return task


HOLD = TaskKind(
    name="hold",
    spec=HoldSpec,
    entry=HoldEntry,
    build=lambda spec, tree: TaskSetup(HoldEntry(steps=spec.steps)),
    run=bind,
    poses=None,
)


@pytest.mark.parametrize("is_plugin", [True, False], ids=["a plug-in's record", "a script's object"])
def test_a_task_from_outside_is_the_same_on_one_infant_on_many_and_on_a_device(registered, make, is_plugin):
    """To the bit on one and on many, within the rounding of 32 bits on a device; also what it changes in the model."""
    with registered(HOLD):
        options = {} if is_plugin else {"task": HoldTask(STEPS)}
        task = {"task": {"kind": "hold", "steps": STEPS}} if is_plugin else {}
        bundles = [mimoc.build(spec(age, scene=SITTING, **task)) for age in (9, 12)]
        many, device = make(bundles, device="cpu", threads=1, **options), make(bundles, starts=2, **options)
        alone = [mimoc.InfantEnv(bundle, **({} if is_plugin else {"task": HoldTask(STEPS)})) for bundle in bundles]
        begun = [env.reset(seed=seed)[0]["height"] for seed, env in enumerate(alone)]
        assert np.array_equal(many.reset(seed=0)[0]["height"], begun)
        assert device.reset(seed=0)[0]["height"] == pytest.approx(np.array(begun))
        generator = np.random.default_rng(0)
        for _ in range(STEPS - 1):
            command = 0.5 * random_actions(many, generator)
            each = [env.step(action) for env, action in zip(alone, command, strict=True)]
            _, rewards, terminated, truncated, info = many.step(command)
            on_device = device.step(command)
            assert rewards.tolist() == [step[1] for step in each]
            assert rewards == pytest.approx(on_device[1], abs=1e-4)
            assert terminated.tolist() == on_device[2].tolist()
            assert truncated.tolist() == on_device[3].tolist() == [False, False]
            assert info["is_success"].tolist() == on_device[4]["is_success"].tolist()
            for name, values in on_device[4]["reward_terms"].items():
                assert values == pytest.approx(info["reward_terms"][name], abs=1e-4)
            head = alone[0].task.model_fields[0].rows[0]
            lightness = [env.model.body_gravcomp[head] for env in alone]
            assert device.worlds.model.body_gravcomp.numpy()[:, head] == pytest.approx(lightness, abs=1e-4)
        assert terminated.all()
        assert lightness != [0.1, 0.1]
        device.step(command)
        assert device.worlds.model.body_gravcomp.numpy()[:, head] == pytest.approx(0.1)
        for env in alone:
            env.close()


def test_a_single_world_takes_over_what_a_start_sets_in_the_model(make):
    env = make(infant(9, scene=SITTING), 1, task=HoldTask())
    env.reset(seed=0)
    lightness = env.worlds.model.body_gravcomp
    lightness.fill_(0.7)
    env.reset(seed=0)
    head = env.infants[0].task.model_fields[0].rows
    assert lightness.numpy()[0, head] == pytest.approx(0.1)
    assert (np.delete(lightness.numpy()[0], head) == np.float32(0.7)).all()


@dataclass(frozen=True)
class Months(Term):
    """A reward that is an address, which it should not be."""

    months: int

    def __call__(self, worlds: Any, action: Any, memory: Any) -> Judgement:
        return Judgement({"months": worlds.qpos[:, 0] + self.months})


class MonthsTask(Task):
    """The same reward at each step."""

    def bind(self, model: Any, bundle: Any) -> None:
        self.term = Months(round(bundle.manifest.child.age_months))


def test_infants_whose_tasks_differ_in_what_worlds_share_are_refused(make):
    bundles = [infant(age, scene=SITTING) for age in (9, 12)]
    with pytest.raises(DeviceError, match="the tasks of these infants differ in 'months'"):
        make(bundles, task=MonthsTask())


class Blinking(MonthsTask):
    """A task whose observation is made elsewhere."""

    spaces = {"light": gymnasium.spaces.Box(0.0, 1.0, (1,), np.float32)}  # noqa: RUF012

    def observe(self) -> Any:
        return {"light": np.ones(1, np.float32)}


def test_an_observation_that_is_not_remembered_is_refused_instead_of_left_out(make):
    with pytest.raises(DeviceError, match="the task observes 'light' without remembering it"):
        make(infant(9, scene=SITTING), 2, task=Blinking())


@dataclass(frozen=True)
class Broken(Term):
    """A reward that is no number, of the second infant."""

    def __call__(self, worlds: Any, action: Any, memory: Any) -> Judgement:
        number = worlds.xp.cumulative_sum(worlds.xp.ones_like(worlds.qpos[:, 0]), axis=0)
        return Judgement({"root": worlds.xp.sqrt(1.5 - number)})


class Flat(Term):
    """A reward for all infants together."""

    def __call__(self, worlds: Any, action: Any, memory: Any) -> Judgement:
        return Judgement({"height": worlds.xpos[:1, 1, 2]})


def test_rewards_are_finite_numbers_of_each_infant(make):
    """The step after it tells of a NaN, as reading it at once would stop the device; shapes are known at once."""
    envs = make(infant(9, scene=SITTING), 2, task=Task(term=Broken()))
    envs.reset(seed=0)
    actions = still(envs)
    envs.step(actions)
    with pytest.raises(DeviceError, match=r"task mimoc\.runtime\.task:Task: the last reward of infant 1 was no finite"):
        envs.step(actions)
    with pytest.raises(TypeError, match="infants on a device cannot be copied or pickled"):
        copy.deepcopy(envs)
    envs = make(infant(9, scene=SITTING), 2, task=Task(term=Flat()))
    envs.reset(seed=0)
    with pytest.raises(KindError, match=r"the term .*test_tasks:Flat: the term 'height' of its reward"):
        envs.step(actions)
