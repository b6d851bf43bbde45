"""A limb of known damping swings as the equation of a damped pendulum says."""

import math

import mujoco
import numpy as np
import pytest

from mimoc.schema.infant import InfantSpec
from mimoc.studies.milestones.infant import Conditions, TrialInfant, compile_at
from mimoc.studies.movement.pendulum import MIN_DEG, damping_ratio, swing
from mimoc.studies.movement.trial import Subject

LENGTH_M, MASS_KG, RADIUS_M, ARMATURE, GRAVITY = 0.15, 0.3, 0.02, 1e-4, 9.81
INERTIA = MASS_KG * LENGTH_M**2 + 0.4 * MASS_KG * RADIUS_M**2 + ARMATURE
MOMENT = MASS_KG * GRAVITY * LENGTH_M
START_DEG = 20.0


def limb(ratio, *, friction_nm=0.0):
    """Return an infant whose only limb is a ball on a weightless rod, with some damping ratio."""
    damping = 2 * ratio * math.sqrt(MOMENT * INERTIA)
    model = mujoco.MjModel.from_xml_string(f"""
    <mujoco>
      <option timestep="0.001" integrator="RK4"/>
      <worldbody>
        <geom name="floor" type="plane" size="1 1 1"/>
        <body name="hip">
          <freejoint/>
          <geom type="sphere" size="0.05" mass="1"/>
          <body name="left_lower_leg">
            <joint name="robot:left_knee" axis="0 1 0" range="-150 150" damping="{damping}" armature="{ARMATURE}"
                   frictionloss="{friction_nm}"/>
            <geom type="sphere" size="{RADIUS_M}" mass="{MASS_KG}" pos="0 0 {-LENGTH_M}"/>
          </body>
        </body>
      </worldbody>
      <actuator><motor joint="robot:left_knee" gear="1" ctrlrange="-1 1" forcerange="-1 1"/></actuator>
    </mujoco>""")
    return TrialInfant(model, np.array([1], np.intp), (0.0, 0.0))


@pytest.mark.parametrize("ratio", [0.09, 0.1, 0.2, 0.35])
def test_the_number_of_swings_is_that_of_the_damping(ratio):
    """Half swings shrink by exp(-pi zeta / sqrt(1 - zeta²)); those of more than a degree count."""
    decrement = math.pi * ratio / math.sqrt(1 - ratio**2)
    half_swings = math.floor(math.log(START_DEG / MIN_DEG) / decrement)
    moved = swing(limb(ratio), "left_knee", START_DEG, {})
    assert moved.swings == half_swings / 2
    assert moved.index == pytest.approx(1 + math.exp(-decrement), abs=0.01)
    assert moved.rest_deg == pytest.approx(0.0, abs=0.2)


def test_the_period_is_that_of_the_pendulum():
    moved = swing(limb(0.1), "left_knee", START_DEG, {})
    period_s = 2 * math.pi * math.sqrt(INERTIA / MOMENT / (1 - 0.1**2))
    assert moved.period_s == pytest.approx(period_s, rel=0.02)


def test_more_than_critical_damping_does_not_swing():
    moved = swing(limb(1.2), "left_knee", START_DEG, {})
    assert (moved.swings, moved.period_s) == (0.0, None)
    assert moved.index == pytest.approx(1.0)


@pytest.mark.parametrize("ratio", [0.06, 0.2, 1.2])
def test_the_damping_ratio_is_read_from_the_model(ratio):
    assert damping_ratio(limb(ratio), "left_knee") == pytest.approx(ratio, rel=1e-4)


def test_friction_takes_swings_away_that_the_damping_ratio_does_not_tell_of():
    free, rubbing = limb(0.06), limb(0.06, friction_nm=0.1 * MOMENT)
    assert damping_ratio(free, "left_knee") == damping_ratio(rubbing, "left_knee")
    assert swing(rubbing, "left_knee", START_DEG, {}).swings < swing(free, "left_knee", START_DEG, {}).swings


def test_a_compiled_shank_with_less_damping_swings_more():
    spec = InfantSpec(mimoc=1, name="child", age_months=6)
    swings = []
    for factor in (1.0, 0.05):
        body = Subject(compile_at(spec, 6.0, Conditions()), spec).slack
        body.model.dof_damping[:] *= factor
        body.model.dof_frictionloss[:] = 0.0
        swings.append(swing(body, "left_knee", 0.0, {"left_hip1": -90.0}).swings)
    assert swings[0] < swings[1]
