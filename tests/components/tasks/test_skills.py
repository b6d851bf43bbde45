"""Motor skills: what counts as success, what does not, and what infants begin with."""

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.runtime.task import FORCES
from mimoc.schema.kinds import SKILLS

SENSES = {"proprioception": {"include": ["velocity"]}, "vestibular": {}}
STILL = {"noise": {"motor": 0.0}, "delays": {"preset": "none"}}


def infant(kind: str, age_months: float = 9, spec: dict | None = None, **options):
    keys = {"mimoc": 1, "name": "kim", "age_months": age_months, "senses": SENSES, **(spec or {})}
    env = mimoc.make(mimoc.InfantSpec(**keys, task={"kind": kind, **options})).unwrapped
    env.reset(seed=0)
    return env


def at_rest(env):
    return np.clip(np.zeros(env.action_space.shape), env.action_space.low, env.action_space.high).astype(np.float32)


def lie(env, pose: str) -> None:
    """Put an infant into a pose, where it is."""
    start = env.model.keyframe(pose).qpos
    env.data.qpos[2:7], env.data.qpos[7 : len(start)] = start[2:7], start[7:]
    env.data.qvel[:] = 0.0
    mujoco.mj_forward(env.model, env.data)


@pytest.mark.full
@pytest.mark.parametrize("kind", SKILLS)
def test_neither_chance_nor_rest_has_a_skill(kind):
    env = infant(kind, 6)
    for policy in (lambda: at_rest(env), env.action_space.sample):
        for seed in range(2):
            env.reset(seed=seed)
            env.action_space.seed(seed)
            ended = False
            while not ended:
                _, _, terminated, truncated, info = env.step(policy())
                ended = terminated or truncated
            assert not info["is_success"], (kind, seed)


@pytest.mark.parametrize(("start", "other"), [("supine", "prone"), ("prone", "supine")])
def test_who_lies_on_the_other_side_for_half_a_second_has_rolled(start, other):
    env = infant("roll", start=start)
    for goal in (start, other):
        lie(env, goal)
        successes = [env.step(at_rest(env))[4]["is_success"] for _ in range(30)]
        assert successes[-1] == (goal == other)
        assert not successes[10]
    lie(env, start)
    assert env.step(at_rest(env))[4]["is_success"]  # What was reached stays reached.


def test_the_way_counts_only_in_the_posture():
    for pose, counts in (("prone", True), ("supine", False)):
        env = infant("crawl", spec=STILL)
        lie(env, pose)
        before_m = float(env.task.memory["walked_m"])
        for _ in range(10):
            env.data.qpos[0] += 0.06
            _, _, terminated, _, info = env.step(at_rest(env))
            if terminated:
                break
        assert info["is_success"] == counts
        assert (float(env.task.memory["walked_m"]) - before_m > 0.5) == counts


def test_on_hands_and_knees_nothing_else_touches_the_floor():
    for age_months in (6, 9, 14):
        env = infant("crawl", age_months, style="hands_and_knees")
        _, _, _, _, info = env.step(at_rest(env))
        assert info["reward_terms"]["on_all_fours"] > 0
    for _ in range(100):
        _, _, _, _, info = env.step(at_rest(env))
    assert info["reward_terms"]["on_all_fours"] == 0  # It has sunk down.


@pytest.mark.parametrize("kind", ["sit", "stand", "walk", "cruise"])
def test_who_gives_way_falls_and_the_episode_ends(kind):
    env = infant(kind)
    steps = 0
    terminated = False
    while not terminated:
        _, _, terminated, truncated, _ = env.step(at_rest(env))
        steps += 1
        assert not truncated
    assert 10 < steps < 100


def test_pushes_come_when_they_were_drawn_and_are_gone_after_a_reset():
    env = infant("sit", pushes=2)
    chest = env.model.body("upper_body").id
    at, newtons = env.task.memory["push_at"], env.task.memory["push_n"]
    weight_n = 9.81 * env.model.body_subtreemass[0]
    assert np.linalg.norm(newtons, axis=1) == pytest.approx(0.05 * weight_n, rel=1e-3)
    for _ in range(int(at[0]) + 3):
        lie(env, "sitting")
        env.step(at_rest(env))
        step = float(env.task.memory["step"])
        is_pushed = at[0] <= step < at[0] + 10
        assert env.data.xfrc_applied[chest, :2] == pytest.approx(newtons[0] if is_pushed else np.zeros(2))
    env.reset(seed=1)
    assert not env.data.xfrc_applied.any()
    assert not np.array_equal(env.task.memory["push_at"], at)


def test_a_helper_carries_a_drawn_share_of_the_weight():
    env = infant("walk", support=0.5)
    weight_n, shares = 9.81 * env.model.body_subtreemass[0], []
    for seed in range(20):
        env.reset(seed=seed)
        env.step(at_rest(env))
        shares.append(getattr(env.data, FORCES)[env.model.body("upper_body").id, 2] / weight_n)
    assert min(shares) >= 0
    assert max(shares) <= 0.5 + 1e-6
    assert max(shares) - min(shares) > 0.2


def test_who_learns_a_skill_has_the_nervous_system_of_its_age_unless_told_otherwise():
    keys = {"mimoc": 1, "name": "kim", "age_months": 6, "senses": SENSES}
    spec = mimoc.InfantSpec(**keys, task={"kind": "roll"})
    assert (spec.noise.motor, spec.delays.preset, spec.actuation.bandwidth_hz) == ("maturing", "physiological", 5.0)
    told = mimoc.InfantSpec(**keys, task={"kind": "roll"}, **STILL)
    assert (told.noise.motor, told.delays.preset, told.actuation.bandwidth_hz) == (0.0, "none", 5.0)
    free = spec.with_(task=None)
    assert (free.noise.motor, free.delays.preset, free.actuation.bandwidth_hz) == (0.0, "none", None)
    assert mimoc.InfantSpec(**keys, task={"kind": "rollover"}).actuation.bandwidth_hz is None
    servos = mimoc.InfantSpec(**keys, task={"kind": "roll"}, actuation={"model": "position"})
    assert (servos.noise.motor, servos.delays.preset) == (0.0, "physiological")  # Their commands are no effort.


@pytest.mark.parametrize("kind", [*SKILLS, "rollover"])
def test_the_config_is_this_task(kind):
    spec = mimoc.load_spec(f"configs/{kind}.yaml")
    assert spec.task.kind == spec.name == kind
