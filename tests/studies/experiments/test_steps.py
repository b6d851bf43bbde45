"""How steps are driven and measured."""

from itertools import pairwise

import mujoco
import numpy as np
import pytest

from mimoc.base.units import GRAVITY_M_S2
from mimoc.studies.experiments.legs import Setup, legs_of, open_infant
from mimoc.studies.experiments.steps import (
    DRAG,
    LIMB_KG_M3,
    WATER_KG_M3,
    AlternateSteps,
    StepCase,
    Water,
    broadsides_m2,
    stepping,
    summarise_steps,
)


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


@pytest.fixture
def standing():
    env = open_infant(Setup(1.0, held=True))
    env.reset(seed=0)
    return env


def test_water_carries_legs_but_for_the_share_by_which_they_are_denser(standing):
    model, legs = standing.model, legs_of(standing.model)
    dry_n = GRAVITY_M_S2 * model.body_mass[legs].sum()
    water = Water(model)
    water(standing.data)
    weight_n = GRAVITY_M_S2 * model.body_mass[legs].sum()
    assert weight_n - standing.data.xfrc_applied[legs, 2].sum() == pytest.approx(dry_n * (1 - WATER_KG_M3 / LIMB_KG_M3))


def test_as_much_water_moves_along_as_is_displaced(standing):
    model, legs = standing.model, legs_of(standing.model)
    dry_kg = model.body_mass.copy()
    Water(model)
    added_kg = model.body_mass - dry_kg
    assert added_kg[legs] == pytest.approx(dry_kg[legs] * WATER_KG_M3 / LIMB_KG_M3)
    assert np.delete(added_kg, legs) == pytest.approx(0)


def test_drag_is_against_the_way_and_goes_with_the_square_of_speed(standing):
    model, data = standing.model, standing.data
    water, shank = Water(model), model.body("left_lower_leg").id
    forces = []
    for speed_m_s in (0.0, 0.5, 1.0):
        data.qvel[:] = 0.0
        data.qvel[0] = speed_m_s  # All of the infant forwards.
        mujoco.mj_forward(model, data)
        water(data)
        forces.append(data.xfrc_applied[shank, 0])
    area_m2 = broadsides_m2(model, [shank])[0]
    assert forces[0] == pytest.approx(0)
    assert forces[1] < 0
    assert forces[2] == pytest.approx(4 * forces[1])
    assert 0.001 < area_m2 < 0.02


def test_drag_is_half_density_times_coefficient_times_area(standing):
    model, data = standing.model, standing.data
    shank = model.body("left_lower_leg").id
    area_m2 = broadsides_m2(model, [shank])[0]
    water = Water(model)
    data.qvel[:] = 0.0
    data.qvel[0] = 1.0
    mujoco.mj_forward(model, data)
    water(data)
    assert data.xfrc_applied[shank, 0] == pytest.approx(-0.5 * WATER_KG_M3 * DRAG * area_m2)


def test_the_broadside_of_a_brick_is_its_largest_side():
    model = mujoco.MjModel.from_xml_string(
        "<mujoco><worldbody><body><freejoint/><geom type='box' size='.1 .2 .3' mass='2'/></body></worldbody></mujoco>"
    )
    assert broadsides_m2(model, [1]) == pytest.approx([0.4 * 0.6])
