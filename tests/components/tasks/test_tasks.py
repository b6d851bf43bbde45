"""What holds of every task."""

import copy
import pickle
from dataclasses import dataclass
from typing import Any, get_args

import gymnasium
import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from support.full import full_but

import mimoc
from mimoc.base.kinds import function_of
from mimoc.bundle.model import simulation_warnings
from mimoc.compiler.child import child_of
from mimoc.compiler.task_setup import build_task
from mimoc.runtime import env_name
from mimoc.runtime.model_fields import ModelField
from mimoc.runtime.task import Change, Judgement, Task
from mimoc.runtime.term import Term
from mimoc.schema.kinds import TASKS

KINDS = tuple(TASKS)
BODIES = [
    (0, "mitten", "torque"),
    (6, "five_finger", "muscle"),
    (18, "mitten", "muscle"),
    (24, "five_finger", "torque"),
]
BODIES += [(9, "mitten", "position")]
FROM_MONTHS = {"standup": 3, "pull_to_stand": 3}
"""The youngest infants that a task is for, where these are not the newborn."""


def make(
    kind: str, age_months: float = 9, hands: str = "mitten", actuation: str = "torque", **options
) -> gymnasium.Env:
    return gymnasium.make(env_name(kind), age_months=age_months, hands=hands, actuation=actuation, **options)


def actions(env, count: int, seed: int = 0):
    low, high = env.action_space.low, env.action_space.high
    return np.random.default_rng(seed).uniform(low, high, (count, *low.shape)).astype(np.float32)


@pytest.mark.parametrize("kind", KINDS)
def test_a_record_names_spec_entry_builder_and_binder_of_its_task(kind):
    record = TASKS[kind]
    assert kind in get_args(record.entry.model_fields["kind"].annotation)
    assert record.spec.model_validate({"kind": kind}).kind == kind
    assert callable(function_of(record.build, "build"))
    assert callable(function_of(record.run, "bind"))
    assert env_name(kind) == f"mimoc/{kind.title().replace('_', '')}-v0"


@pytest.mark.parametrize("kind", KINDS)
def test_gymnasium_has_nothing_against_it(kind, recwarn):
    with make(kind) as env:
        check_env(env.unwrapped)
    assert not [str(warning.message) for warning in recwarn if "mimoc" in str(warning.filename)]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("body", full_but(BODIES[1:4:2], BODIES), ids=str)
def test_random_commands_are_survived_by_every_body(kind, body):
    """Rewards are finite and the sum of their terms; no simulation breaks down."""
    age_months, hands, actuation = body
    with make(kind, max(age_months, FROM_MONTHS.get(kind, 0)), hands, actuation) as env:
        env.reset(seed=0)
        for action in actions(env, 150):
            observation, reward, terminated, truncated, info = env.step(action)
            assert np.isfinite(reward)
            assert reward == pytest.approx(sum(info["reward_terms"].values()))
            assert isinstance(info["is_success"], bool)
            assert not simulation_warnings(env.unwrapped.data)
            if terminated or truncated:
                env.reset()
        assert observation in env.observation_space


@pytest.mark.parametrize("kind", KINDS)
def test_an_episode_is_cut_off_after_its_steps(kind):
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "task": {"kind": kind, "steps": 3}}
    with mimoc.make(mimoc.InfantSpec.model_validate(spec)) as env:
        for _ in range(2):
            env.reset(seed=0)
            ends = [env.step(np.zeros(env.action_space.shape, np.float32))[2:4] for _ in range(3)]
            assert [truncated for _, truncated in ends] == [False, False, True]


@pytest.fixture(scope="module")
def tree():
    return child_of(mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 9})).tree


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("step_ms", [0.1, 7.5, 40.0])
def test_an_episode_lasts_as_long_with_any_control_step(kind, step_ms, tree):
    record = TASKS[kind]
    spec, usual_ms = record.spec.model_validate({"kind": kind}), record.step_ms
    usual, entry = (build_task(spec, tree, control_ms).entry for control_ms in (usual_ms, step_ms))
    counted = {key: value for key, value in usual if key in ("steps", "held_steps", "settle_steps") and value}
    for key, steps in counted.items():
        assert getattr(entry, key) * step_ms == pytest.approx(steps * usual_ms, abs=step_ms / 2)
    assert entry.model_copy(update=counted) == usual
    record.entry.model_validate_json(entry.model_dump_json(), strict=True)


@pytest.mark.parametrize(
    ("task", "step_ms", "steps"),
    [
        ({"kind": "roll"}, None, 250),
        ({"kind": "roll"}, 10.0, 500),
        ({"kind": "roll", "steps": 70}, 10.0, 70),
        ({"kind": "rollover"}, None, 500),
        ({"kind": "rollover"}, 50.0, 100),
        ({"kind": "selfbody"}, 10.0, 250),
        ({"kind": "free", "steps": 500}, 20.0, 500),
        ({"kind": "free"}, 20.0, None),
    ],
    ids=str,
)
def test_a_bundle_says_after_how_many_control_steps_an_episode_ends(task, step_ms, steps):
    control = {"control": {"step_ms": step_ms}} if step_ms else {}
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 9, "task": task, **control})
    manifest = mimoc.build(spec).manifest
    assert manifest.task.steps == steps
    if task["kind"] == "rollover":
        assert manifest.task.settle_steps * manifest.step_ms == 1000


@pytest.mark.parametrize("kind", KINDS)
def test_what_follows_a_state_follows_it_in_another_environment(kind):
    with make(kind) as first, make(kind) as second:
        env, other = first.unwrapped, second.unwrapped
        env.reset(seed=0)
        for action in actions(env, 10):
            env.step(action)
        state = env.get_state()
        other.reset(seed=9)
        other.set_state(state)
        for action in actions(env, 30, seed=1):
            mine, theirs = env.step(action), other.step(action)
            assert mine[1:4] == theirs[1:4]
            assert all(np.array_equal(mine[0][key], theirs[0][key]) for key in mine[0])
            if mine[2]:
                break
        assert np.array_equal(env.reset()[0]["proprioception"], other.reset()[0]["proprioception"])


@pytest.mark.matrix
@pytest.mark.parametrize("kind", KINDS)
def test_it_starts_at_rest_and_stays_together(kind):
    """At the start nothing flies off: constraints and contacts are where they should be."""
    for age_months in (FROM_MONTHS.get(kind, 0), 9, 24):
        with make(kind, age_months) as made:
            env = made.unwrapped
            env.reset(seed=0)
            assert env.data.contact.dist[: env.data.ncon].min(initial=0.0) > -0.004
            at_rest = np.array(env.data.ctrl[env.actuation.actuators], np.float32)
            for _ in range(5):
                env.step(at_rest)
            assert np.abs(env.data.qvel).max() < 12


def test_a_bundle_of_another_task_is_compiled_for_this_one(tmp_path):
    spec = {
        "mimoc": 1,
        "name": "x",
        "age_months": 7,
        "senses": {"proprioception": {}},
        "body": {"hands": "five_finger"},
    }
    folder = mimoc.write_bundle(mimoc.build(mimoc.InfantSpec.model_validate(spec)), tmp_path / "out")
    with gymnasium.make("mimoc/Reach-v0", bundle=folder) as env:
        manifest = env.unwrapped.manifest
        assert (manifest.task.kind, manifest.child.age_months, env.action_space.shape) == ("reach", 7.0, (29,))
    reaching = mimoc.build(mimoc.InfantSpec.model_validate({**spec, "task": {"kind": "reach", "steps": 7}}))
    with gymnasium.make("mimoc/Reach-v0", bundle=reaching) as env:
        assert env.unwrapped.manifest.task.steps == 7


def test_many_can_be_made_at_once():
    envs = gymnasium.make_vec("mimoc/Reach-v0", num_envs=2, vectorization_mode="sync", age_months=3)
    envs.reset(seed=0)
    assert envs.step(envs.action_space.sample())[1].shape == (2,)
    envs.close()


def test_a_child_that_there_is_none_of_is_refused():
    with pytest.raises(mimoc.MimocError, match="age_months: 99 is too large"):
        gymnasium.make("mimoc/Reach-v0", age_months=99)


@pytest.mark.parametrize(
    ("options", "told"),
    [
        ({"age_months": np.float64(7), "hand": "left", "steps": 9}, ("left_fingers", 9)),
        ({"age_months": np.int64(3), "actuation": "muscle"}, ("right_fingers", 1000)),
    ],
    ids=str,
)
def test_choices_of_a_task_can_be_made_by_name(options, told):
    with gymnasium.make("mimoc/Reach-v0", **options) as env:
        task = env.unwrapped.manifest.task
        assert (task.effector, task.steps) == told


def test_a_bundle_says_what_infant_it_is():
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 7})
    with pytest.raises(mimoc.MimocError, match="leave out age_months, or the bundle"):
        gymnasium.make("mimoc/Reach-v0", bundle=mimoc.build(spec), age_months=3)


@pytest.mark.parametrize(
    ("actuation", "problem"),
    [
        ({"regions": ["legs"]}, r"actuation\.regions: none of .* commanded actuators moves a joint of task 'reach'"),
        ({"locked": ["right_arm", "right_hand"]}, r"actuation\.locked: none of .* moves a joint of task 'reach'"),
    ],
    ids=str,
)
def test_a_task_that_leaves_nothing_to_command_is_refused(actuation, problem):
    spec = {"mimoc": 1, "name": "x", "age_months": 7, "actuation": actuation, "task": {"kind": "reach"}}
    with pytest.raises(mimoc.MimocError, match=problem):
        mimoc.build(mimoc.InfantSpec.model_validate(spec))


@pytest.mark.parametrize(
    ("kind", "hands", "count"), [("reach", "mitten", 8), ("selfbody", "mitten", 8), ("selfbody", "five_finger", 29)]
)
def test_only_one_arm_and_its_hand_take_commands(kind, hands, count):
    with make(kind, hands=hands, hand="left") as env:
        actuators = env.unwrapped.manifest.actuation.actuators
    commanded = [actuator.name for actuator in actuators if actuator.commanded]
    assert len(commanded) == count
    assert all(name.startswith("act:left_") for name in commanded)


@pytest.mark.parametrize("kind", ["catch", "reach", "selfbody"])
def test_an_infant_without_the_hand_is_refused(kind):
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "body": {"remove": ["left_hand"]}}
    with pytest.raises(mimoc.MimocError, match=rf"task '{kind}' requires left_fingers.*, which this infant does not"):
        mimoc.build(mimoc.InfantSpec.model_validate({**spec, "task": {"kind": kind, "hand": "left"}}))
    right = mimoc.build(mimoc.InfantSpec.model_validate({**spec, "task": {"kind": kind, "hand": "right"}}))
    assert right.manifest.task.kind == kind


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
