"""Buoyancy and drag."""

import mujoco
import numpy as np
import pytest

from mimoc.base.units import GRAVITY_M_S2
from mimoc.studies.experiments.legs.infants import Setup, legs_of, open_infant
from mimoc.studies.experiments.legs.steps import DRAG, LIMB_KG_M3, WATER_KG_M3, Water, broadsides_m2


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
