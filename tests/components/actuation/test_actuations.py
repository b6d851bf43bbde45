"""What every actuation model keeps to, with either hands."""

from functools import cache
from typing import get_args

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from support import store
from support.full import full_but, full_rows

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.compiler.actuation import build_actuation
from mimoc.fits import measure
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
    assert len(actuators) == (46 if len(tree.motors) < 50 else 90) * (2 if model == "muscle" else 1)


@pytest.mark.parametrize("model", ACTUATIONS)
def test_an_actuation_model_leaves_a_joint_all_but_its_spring_and_damper(model, driven):
    plain, changed = driven("torque", 9, "five_finger"), driven(model, 9, "five_finger")
    for what in ("jnt_axis", "jnt_range", "dof_frictionloss", "dof_armature", "jnt_pos", "body_mass"):
        assert np.array_equal(getattr(changed, what), getattr(plain, what)), what


def test_every_actuation_of_the_manifest_is_in_the_table():
    assert list(ACTUATIONS) == list(get_args(ActuationEntry.model_fields["model"].annotation))


@pytest.mark.parametrize("model", ACTUATIONS)
def test_an_action_has_the_range_of_its_actuators(open_env, model):
    env = open_env(actuation={"model": model})
    actuators, space = env.manifest.actuation.actuators, env.action_space
    ranges = np.stack([space.low, space.high], axis=1)
    assert ranges.tolist() == [[actuator.action_low, actuator.action_high] for actuator in actuators]
    assert np.array_equal(ranges, env.model.actuator_ctrlrange)
    assert {*space.low} == {0 if model == "muscle" else -1}


@pytest.mark.parametrize(
    ("model", "development", "drive"),
    [
        ("torque", "maturing", "activation"),
        ("torque", "published", "command"),
        ("muscle", "maturing", "activation"),
        ("position", "maturing", "command"),
    ],
)
def test_drives_and_torques_are_felt(open_env, model, development, drive):
    env = open_env(actuation={"model": model}, development=development, scene={"kind": "flat", "pose": "sitting"})
    env.reset(seed=0)
    for _ in range(5):
        command = env.np_random.uniform(env.action_space.low, env.action_space.high).astype(np.float32)
        observation, *_ = env.step(command)
    felt = dict(zip(env.layout("proprioception"), observation["proprioception"], strict=True))
    torques_nm = env.data.actuator_force * env.model.actuator_gear[:, 0]
    for index, actuator in enumerate(env.manifest.actuation.actuators):
        driven = command[index] if drive == "command" else env.data.act[index]
        assert felt[f"{actuator.name} {drive} [1]"] == pytest.approx(driven)
        assert felt[f"{actuator.name} torque [N m]"] == pytest.approx(torques_nm[index], rel=1e-6)
