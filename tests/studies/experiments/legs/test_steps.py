"""How steps are driven and measured."""

from itertools import pairwise

import numpy as np
import pytest

from mimoc.studies.experiments.legs.infants import Setup, open_infant
from mimoc.studies.experiments.legs.steps import AlternateSteps, StepCase, stepping, summarise_steps


@pytest.fixture(scope="module")
def env():
    env = open_infant(Setup(1.0, held=True))
    env.reset(seed=0)
    return env


def test_legs_are_bent_in_turn(env):
    policy, generator = AlternateSteps(env), np.random.default_rng(0)
    actions = np.array([policy(generator, {}) for _ in range(2000)])
    names = [env.model.actuator(int(index)).name for index in env.actuation.actuators]
    left, right = (actions[:, names.index(f"act:{side}_hip_flex_negative")] for side in ("left", "right"))
    assert left.max() > 0
    assert right.max() > 0
    assert not ((left > 0) & (right > 0)).any()
    starts = sorted(
        (int(frame), side)
        for side, level in (("left", left), ("right", right))
        for frame in np.flatnonzero((level[1:] > 0) & (level[:-1] == 0))
    )
    assert all(first[1] != second[1] for first, second in pairwise(starts))


def test_a_lift_of_a_leg_is_a_step(env):
    qpos = np.repeat(env.data.qpos[None], 1000, axis=0)
    lift = np.clip(np.sin(np.arange(1000) * 2 * np.pi / 200), 0, 1)
    for joint, size in (("hip1", -1.0), ("knee", -1.0)):
        qpos[:, env.model.joint(f"robot:left_{joint}").qposadr[0]] += size * lift
    values = summarise_steps(env.model, qpos, 100.0)
    assert values["rate_per_min"] == pytest.approx(30.0)
    assert values["lift_cm"] > 1


def test_an_infant_without_drive_takes_no_step(env):
    assert summarise_steps(env.model, np.repeat(env.data.qpos[None], 500, axis=0), 100.0)["rate_per_min"] == 0


def test_a_weight_at_the_ankles_lowers_the_lift_and_water_raises_it():
    plain, heavy, wet = (
        stepping(StepCase(1.5, 12.0, **conditions), 0).values["lift_cm"]
        for conditions in ({}, {"weight_kg": 0.1}, {"water": True})
    )
    assert heavy < 0.9 * plain
    assert wet > 1.2 * plain
