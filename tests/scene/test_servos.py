"""Servos on the compiled model: any pose is reached in time and held against gravity, at any age."""

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.body import assemble, grow
from mimoc.body.heft import heaviest_inertias
from mimoc.fits import measure

AGES_MONTHS = (0, 3, 9, 18, 24)
HANDS = ("mitten", "five_finger")
STEPS_IN_300_MS, STEPS_IN_500_MS = 60, 100
DOWN, FORWARD, SIDEWAYS = (0, 0, -9.81), (9.81, 0, 0), (0, 9.81, 0)
HEAD_SHARE = 0.6
"""Tendons let the head turn about one axis less far while it is turned about another."""


@pytest.fixture(scope="module", params=HANDS)
def hands(request):
    return request.param


@pytest.fixture(scope="module", params=AGES_MONTHS)
def held(request, hands):
    """Return an infant whose hip is fixed, and which collides with nothing."""
    spec = {"mimoc": 1, "name": "x", "age_months": request.param, "actuation": {"model": "position"}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate({**spec, "body": {"hands": hands}}))
    infant = mujoco.MjSpec.from_string(bundle.files["infant.xml"].decode(), assets=dict(bundle.files))
    infant.delete(infant.joint("mimo_location"))
    model = infant.compile()
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    return model


def angles_of(model, commands):
    """Return the angles that commands stand for."""
    low, high = model.jnt_range[model.actuator_trnid[:, 0]].T
    return low + (commands + 1) / 2 * (high - low)


def upright(model):
    """Return the commands for all joints at zero."""
    low, high = model.jnt_range[model.actuator_trnid[:, 0]].T
    return np.clip(-(high + low) / (high - low), -1, 1)


def errors_deg(model, start, goal, steps):
    """Return how far each joint is from its goal after each step, shape (steps, n)."""
    data, driven = mujoco.MjData(model), model.jnt_qposadr[model.actuator_trnid[:, 0]]
    data.qpos[driven] = angles_of(model, start)
    for motion, ratio in (("lean", 2), ("rot", 1), ("bend", 1)):
        data.joint(f"robot:hip_{motion}2").qpos = ratio * data.joint(f"robot:hip_{motion}1").qpos
    data.act[:], data.ctrl[:] = start, goal
    errors = []
    for _ in range(steps):
        mujoco.mj_step(model, data)
        errors.append(np.degrees(data.qpos[driven] - angles_of(model, goal)))
    assert not data.warning.number.any()
    return np.array(errors)


def names(model):
    return [model.actuator(index).name for index in range(model.nu)]


@pytest.mark.parametrize("gravity", [DOWN, FORWARD, SIDEWAYS], ids=["down", "forward", "sideways"])
def test_a_pose_is_reached_in_300_ms_and_held_against_gravity(held, gravity):
    held.opt.gravity[:] = gravity
    generator = np.random.default_rng(0)
    for _ in range(3):
        goal = generator.uniform(-0.9, 0.9, held.nu)
        goal[["head" in name for name in names(held)]] *= HEAD_SHARE
        errors = errors_deg(held, upright(held), goal, 2 * STEPS_IN_500_MS)
        late = errors[STEPS_IN_300_MS:]
        assert np.abs(late).max() < 1, names(held)[np.abs(late).max(axis=0).argmax()]
        assert np.ptp(errors[STEPS_IN_500_MS:], axis=0).max() < 0.2


def test_a_joint_goes_from_end_to_end_without_overshoot(held):
    held.opt.gravity[:] = DOWN
    for index, name in enumerate(names(held)):
        if name.startswith("act:right"):
            continue
        reach = HEAD_SHARE if "head" in name else 0.98
        start, goal = upright(held), upright(held)
        start[index], goal[index] = -reach, reach
        error = errors_deg(held, start, goal, STEPS_IN_500_MS)[:, index]
        assert error.max() < 0.5, name
        assert np.abs(error[STEPS_IN_300_MS:]).max() < 1, name


def test_commands_span_the_range_of_a_joint(driven):
    """And without them a servo does what the joint's own spring and damper leave to do."""
    model = driven("position", 9, "five_finger")
    plain = driven("torque", 9, "five_finger")
    ids = model.actuator_trnid[:, 0]
    dofs, at = model.jnt_dofadr[ids], model.jnt_qposadr[ids]
    data = mujoco.MjData(model)
    for command in (-1.0, 0.0, 0.7, 1.0):
        data.act[:] = command
        data.qpos[at] = angles_of(model, np.full(model.nu, command))
        mujoco.mj_forward(model, data)
        forces = data.qfrc_actuator[dofs] + data.qfrc_spring[dofs]
        assert forces == pytest.approx(0, abs=1e-6 * model.actuator_gainprm[:, 0].max())
    assert np.array_equal(model.jnt_stiffness, plain.jnt_stiffness)


@pytest.mark.parametrize("pose", ["supine", "prone", "sitting", "standing"])
@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_every_keyframe_holds_its_pose(driven, age_months, pose):
    """From the first step on, lying or standing on the ground."""
    model = driven("position", age_months, "mitten")
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    driven_at = model.jnt_qposadr[model.actuator_trnid[:, 0]]
    start = data.qpos[driven_at].copy()
    for _ in range(STEPS_IN_300_MS):
        mujoco.mj_step(model, data)
        assert np.degrees(np.abs(data.qpos[driven_at] - start)).max() < 2
    assert np.degrees(np.abs(data.qpos[driven_at] - start)).max() < 1


def inertias(model, data):
    """Return the diagonal of the mass matrix, which `mj_fullM` gives with other arguments in each MuJoCo."""
    columns = np.zeros((model.nv, model.nv))
    for column, unit in zip(columns, np.eye(model.nv), strict=True):
        mujoco.mj_mulM(model, data, column, unit)
    return np.diag(columns)


@pytest.mark.parametrize("age_months", [0, 24])
def test_no_pose_is_heavier_than_the_heaviest(driven, age_months, hands):
    """The bound that servos are sized by holds in random poses, and is no idle one."""
    bounds = heaviest_inertias(grow(measure(age_months), assemble(hands, hands == "five_finger")))
    model, generator = driven("torque", age_months, hands), np.random.default_rng(0)
    data, largest = mujoco.MjData(model), np.zeros(model.nv)
    low, high = model.jnt_range[1:].T
    for _ in range(50):
        data.qpos[7:] = generator.uniform(low, high)
        mujoco.mj_forward(model, data)
        largest = np.maximum(largest, inertias(model, data))
    bound = np.array([bounds[model.joint(index).name] for index in range(1, model.njnt)])
    assert (largest[6:] <= bound).all()
    assert np.median(bound / largest[6:]) < 2
