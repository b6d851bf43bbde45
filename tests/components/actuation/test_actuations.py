"""What every actuation model keeps to, with either hands."""

from functools import cache
from typing import get_args

import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from support import store
from support.full import full_but, full_rows

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.bundle.model import load_model
from mimoc.compiler.actuation import build_actuation
from mimoc.fits import measure
from mimoc.runtime.actuation import bind_actuation
from mimoc.runtime.check import MAX_ENERGY_J_PER_KG, check_stability
from mimoc.schema.actuation import ActuationEntry, ActuationSpec
from mimoc.schema.kinds import ACTUATIONS

NO_STRENGTH = {"strength": dict.fromkeys(("neck", "trunk", "eyes", "arms", "hands", "legs"), 0)}
CHILDREN = [
    *((0, "mitten"), (0, "five_finger"), (1, "mitten"), (3, "five_finger"), (6, "mitten")),
    *((12, "five_finger"), (18, "mitten"), (24, "mitten"), (24, "five_finger")),
]
"""Age in months, and hands: each age has one kind of hands, and the first and the last both."""
FEW_CHILDREN = [CHILDREN[1], CHILDREN[4], CHILDREN[7]]
EVERYTHING_FELT = {"proprioception": {"include": ["velocity", "torque", "limits", "actuation"]}, "vestibular": {}}


@pytest.fixture(params=["mitten", "five_finger"])
def hands(request):
    return request.param


def infant(model, hands, age_months=9, **actuation):
    spec = {
        "mimoc": 1,
        "name": "x",
        "age_months": age_months,
        "body": {"hands": hands},
        "actuation": {"model": model, **actuation},
        "senses": EVERYTHING_FELT,
    }
    return store.built(spec)


@pytest.mark.full
@pytest.mark.parametrize("model", ACTUATIONS)
def test_gymnasium_has_nothing_against_it(model, hands):
    check_env(mimoc.make(infant(model, hands)).unwrapped)


@pytest.mark.parametrize("model", ACTUATIONS)
def test_an_infant_without_any_strength_is_an_environment_too(model, hands):
    env = mimoc.make(infant(model, hands, **NO_STRENGTH))
    check_env(env.unwrapped)
    env.reset(seed=0)
    env.step(env.action_space.high)
    assert env.unwrapped.effort() == 0


@cache
def checks(model, hands, age_months):
    return tuple(check_stability(infant(model, hands, age_months)))


@pytest.mark.parametrize(("age_months", "hands"), full_rows(FEW_CHILDREN, CHILDREN))
@pytest.mark.parametrize("model", ACTUATIONS)
def test_random_control_is_calm_from_every_pose(model, hands, age_months):
    for check in checks(model, hands, age_months):
        assert check.warnings == (), check
        assert check.energy_j_per_kg < MAX_ENERGY_J_PER_KG, check


@pytest.mark.parametrize("children", full_but([FEW_CHILDREN], [CHILDREN]), ids=["few", "all"])
def test_muscles_move_infants_no_faster_than_motors_do(children):
    """Twice the energy at most: little damping is left to the joints, but fast muscles pull less."""
    fastest = {
        model: max(check.energy_j_per_kg for age, hands in children for check in checks(model, hands, age))
        for model in ("torque", "muscle")
    }
    assert fastest["muscle"] < 2 * fastest["torque"]


TIMESTEP_S = 0.005


@pytest.fixture(scope="module", params=["mitten", "five_finger"])
def tree(request):
    return grow_tree(measure(18), assemble(request.param, True))


@pytest.mark.parametrize("model", ACTUATIONS)
def test_every_actuator_moves_the_joint_of_mimos(model, tree):
    actuators = build_actuation(ActuationSpec(model=model), tree, TIMESTEP_S).actuators
    joints = {motor.name: motor.joint for motor in tree.motors}
    assert {actuator.mimo_actuator for actuator in actuators} == joints.keys()
    assert all(actuator.joint == joints[actuator.mimo_actuator] for actuator in actuators)
    assert len({actuator.name for actuator in actuators}) == len(actuators)


@pytest.mark.parametrize("model", ACTUATIONS)
def test_a_body_has_an_actuator_a_joint_or_two_muscles(model, tree):
    count = len(build_actuation(ActuationSpec(model=model), tree, TIMESTEP_S).actuators) // (
        2 if model == "muscle" else 1
    )
    assert count == (46 if len(tree.motors) < 50 else 90)


@pytest.mark.parametrize("model", ACTUATIONS)
def test_an_actuation_model_leaves_a_joint_all_but_its_spring_and_damper(model, driven):
    plain, changed = driven("torque", 9, "five_finger"), driven(model, 9, "five_finger")
    for what in ("jnt_axis", "jnt_range", "dof_frictionloss", "dof_armature", "jnt_pos", "body_mass"):
        assert np.array_equal(getattr(changed, what), getattr(plain, what)), what


def test_full_activation_is_the_gear_within_the_force_range(infant_at):
    """On the compiled model: torque = gear x activation, cut off at the force range."""
    model = infant_at(18).model
    data = mujoco.MjData(model)
    elbow = model.actuator("act:left_elbow")
    for command, torque_nm in ((1, 0.83 * 3.6), (0.5, 1.8), (-1, -3.6), (-5, -3.6)):
        data.act[elbow.actadr[0]] = command
        mujoco.mj_forward(model, data)
        assert data.joint("robot:left_elbow").qfrc_actuator[0] == pytest.approx(torque_nm)


def test_every_actuation_of_the_manifest_is_in_the_table():
    assert list(ACTUATIONS) == list(get_args(ActuationEntry.model_fields["model"].annotation))


@pytest.mark.parametrize("model", ACTUATIONS)
def test_every_actuation_says_its_range(built, model):
    bundle = built(actuation={"model": model})
    actuation = bind_actuation(bundle.manifest.actuation, load_model(bundle))
    actuators = bundle.manifest.actuation.actuators
    assert list(actuation.low) == [actuator.action_low for actuator in actuators]
    assert list(actuation.high) == [actuator.action_high for actuator in actuators]
