"""Servos on the compiled model: what muscles could hold they hold, at any age, and no more than muscles could."""

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.body.grow import grow_tree
from mimoc.body.strength import FASTEST_RAD_S
from mimoc.components.actuation.position import inertias
from mimoc.fits import measure
from mimoc.runtime.check import COMMANDS, flail

HANDS = ("mitten", "five_finger")
CHILDREN = ((0, "mitten"), (9, "five_finger"), (24, "mitten"))
SETTLED_S, END_S = 1.5, 2.0
HEAD_SHARE = 0.6
"""Tendons let the head turn about one axis less far while it is turned about another."""
WITHIN_DEG = {5: 2.5, 10: 3.5, 20: 6.5}
"""How far from its command a joint is held whose torque is not used up, by physics step in milliseconds."""
NEWBORN = 1.4
"""Factor on that of newborns, whose muscle tone servos hold against."""


def fixed(age_months, hands, timestep_ms):
    """Return an infant whose hip is fixed, and which collides with nothing."""
    control = {"timestep_ms": timestep_ms, "step_ms": 2 * timestep_ms}
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "actuation": {"model": "position"}, "control": control}
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


def names(model):
    return [model.actuator(index).name for index in range(model.nu)]


@pytest.mark.parametrize("timestep_ms", WITHIN_DEG)
@pytest.mark.parametrize(("age_months", "hands"), CHILDREN)
def test_a_pose_is_held_against_gravity_wherever_muscles_are_strong_enough(age_months, hands, timestep_ms):
    """Most joints are within half a degree; those that are not have all of their torque in use."""
    model, generator = fixed(age_months, hands, timestep_ms), np.random.default_rng(0)
    driven, (low, high) = model.jnt_qposadr[model.actuator_trnid[:, 0]], model.actuator_forcerange.T
    for _ in range(2):
        goal = generator.uniform(-0.9, 0.9, model.nu)
        goal[["head" in name for name in names(model)]] *= HEAD_SHARE
        data = mujoco.MjData(model)
        data.act[:], data.ctrl[:] = upright(model), goal
        mujoco.mj_step(model, data, round(SETTLED_S / model.opt.timestep))
        errors, used_up = [], np.zeros(model.nu, bool)
        while data.time < END_S:
            mujoco.mj_step(model, data)
            errors.append(np.degrees(np.abs(data.qpos[driven] - angles_of(model, goal))))
            used_up |= (data.actuator_force <= 0.95 * low) | (data.actuator_force >= 0.95 * high)
        assert not data.warning.number.any()
        worst = np.max(errors, axis=0)[~used_up]
        within_deg = WITHIN_DEG[timestep_ms] * (1.0 if age_months else NEWBORN)
        assert worst.max() < within_deg, np.array(names(model))[~used_up][worst.argmax()]
        assert np.median(worst) < 0.5 * within_deg
        assert used_up.mean() < (0.15 if age_months else 0.45)


@pytest.mark.parametrize("pose", ["supine", "sitting"])
@pytest.mark.parametrize("timestep_ms", [5, 10, 20])
def test_no_physics_step_that_the_spec_allows_breaks_down(timestep_ms, pose):
    """Nor flings a joint out, under random and under alternating commands."""
    control = {"timestep_ms": timestep_ms, "step_ms": 20}
    spec = {"mimoc": 1, "name": "x", "age_months": 6, "actuation": {"model": "position"}, "control": control}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate({**spec, "body": {"hands": "five_finger"}}))
    model = mujoco.MjModel.from_xml_string(bundle.files["scene.xml"].decode(), dict(bundle.files))
    generator = np.random.default_rng(0)
    for commands in COMMANDS.values():
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
        found = flail(data, commands(model, generator, 0.02), 0.02, "hip")
        assert found.warnings == ()
        assert found.beyond_deg < 60, found


def test_no_joint_goes_faster_than_its_muscles_could(driven):
    """But for what other joints do to it: alone in space, from end to end."""
    model = driven("position", 9, "mitten")
    dampings = model.dof_damping[model.jnt_dofadr[model.actuator_trnid[:, 0]]]
    stalls_nm = np.abs(model.actuator_forcerange).max(axis=1)
    assert (stalls_nm / dampings <= FASTEST_RAD_S * (1 + 1e-6)).all()


def test_commands_span_the_range_of_a_joint(driven):
    """And without them a servo does what the joint's own spring leaves to do, at an age without tone."""
    model = driven("position", 18, "five_finger")
    plain = driven("torque", 18, "five_finger")
    model.actuator_forcelimited[:] = 0
    ids = model.actuator_trnid[:, 0]
    dofs, at = model.jnt_dofadr[ids], model.jnt_qposadr[ids]
    data = mujoco.MjData(model)
    for command in (-1.0, 0.0, 0.7, 1.0):
        data.act[:] = command
        data.qpos[at] = angles_of(model, np.full(model.nu, command))
        mujoco.mj_forward(model, data)
        forces = data.qfrc_actuator[dofs] + data.qfrc_spring[dofs]
        assert forces == pytest.approx(0, abs=1e-6 * model.actuator_gainprm[:, 0].max())
    model.actuator_forcelimited[:] = 1
    assert np.array_equal(model.jnt_stiffness, plain.jnt_stiffness)


@pytest.mark.parametrize("pose", ["supine", "prone", "sitting"])
@pytest.mark.parametrize("age_months", [9, 24])
def test_a_keyframe_on_the_ground_holds_its_pose(driven, age_months, pose):
    model = driven("position", age_months, "mitten")
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    driven_at = model.jnt_qposadr[model.actuator_trnid[:, 0]]
    start = data.qpos[driven_at].copy()
    mujoco.mj_step(model, data, 60)
    assert np.degrees(np.abs(data.qpos[driven_at] - start)).max() < 4


@pytest.mark.parametrize("hands", HANDS)
def test_inertias_are_those_of_the_compiled_model(driven, hands):
    """In random poses none is less than half of the least, and one alone, of a twisting trunk, twice the largest."""
    bounds = inertias(grow_tree(measure(9), assemble(hands, hands == "five_finger")))
    model, generator = driven("torque", 9, hands), np.random.default_rng(0)
    data, (low, high) = mujoco.MjData(model), model.jnt_range[1:].T
    for _ in range(10):
        data.qpos[7:] = generator.uniform(low, high)
        mujoco.mj_forward(model, data)
        matrix = np.zeros((model.nv, model.nv))
        for column, unit in zip(matrix, np.eye(model.nv), strict=True):
            mujoco.mj_mulM(model, data, column, unit)
        found = np.diag(matrix)[6:]
        joints = [model.joint(index).name for index in range(1, model.njnt)]
        least, largest = np.array([bounds[joint] for joint in joints]).T
        assert (found > 0.45 * least).all()
        assert (found < np.where(np.array(joints) == "robot:hip_rot1", 2.5, 2.0) * largest).all()


@pytest.mark.parametrize(("hands", "apart"), [("mitten", 1e-6), ("five_finger", 0.05)])
def test_both_sides_are_as_heavy(hands, apart):
    """But for the axis of one metacarpal, which is no mirror of the other (MIMo)."""
    found = inertias(grow_tree(measure(9), assemble(hands, False)))
    for joint, (least, largest) in found.items():
        assert 0 < least <= largest
        assert found[joint.replace("left_", "right_")] == pytest.approx((least, largest), rel=apart)


@pytest.fixture
def env(open_env):
    env = open_env(actuation={"model": "position"}, scene={"kind": "flat", "pose": "supine"})
    env.reset(seed=0)
    return env


def driven_angles(env):
    return np.array([env.data.joint(actuator.joint).qpos[0] for actuator in env.manifest.actuation.actuators])


def test_a_command_is_a_place_in_the_joints_range(env):
    """A lying infant turns its head and lifts its hands to where it is told, as well as its muscles can hold them."""
    ranges = np.array([env.model.joint(actuator.joint).range for actuator in env.manifest.actuation.actuators])
    command = env.data.ctrl.copy()
    names = [actuator.name for actuator in env.manifest.actuation.actuators]
    for name, share in (("act:left_wrist_flexion", 0.5), ("act:right_elbow", -0.2), ("act:left_eye_horizontal", -0.8)):
        command[names.index(name)] = share
    for _ in range(150):
        env.step(command)
    wanted = ranges.mean(axis=1) + command * np.ptp(ranges, axis=1) / 2
    assert np.degrees(driven_angles(env)) == pytest.approx(np.degrees(wanted), abs=3.5)


@pytest.mark.parametrize("pose", ["supine", "prone", "sitting", "standing"])
def test_a_reset_holds_the_pose_it_starts_from(env, pose):
    env.reset(options={"pose": pose})
    start = driven_angles(env)
    for _ in range(30):
        env.step(env.data.ctrl.copy())
    assert np.degrees(driven_angles(env)) == pytest.approx(np.degrees(start), abs=3.5)


def test_servos_cost_what_they_use_of_their_strength(env):
    """At rest next to nothing; all pushed as far as they can, most of the largest share, which is 1 / n."""
    env.step(env.data.ctrl.copy())
    resting = env.effort()
    env.step(-np.sign(env.data.ctrl))
    assert 0 <= resting < 0.1 / env.model.nu < env.effort() <= 1 / env.model.nu


def test_no_servo_is_stronger_than_its_motor(env, open_env):
    """Whatever is commanded, at an age and strength that the spec gives."""
    actuation = {"strength": {"arms": 0.5}, "strength_age_months": 3}
    scene = {"kind": "flat", "pose": "supine"}
    servos = open_env(actuation={**actuation, "model": "position"}, scene=scene)
    motors = open_env(actuation=actuation, scene=scene)
    assert servos.actuation.limits_nm == pytest.approx(motors.actuation.limits_nm, rel=1e-8)
    low, high = servos.actuation.limits_nm.T
    servos.reset(seed=0)
    largest = np.zeros(len(high))
    for _ in range(50):
        servos.step(servos.np_random.choice((-1.0, 1.0), len(high)))
        torques_nm = servos.data.actuator_force
        assert ((low - 1e-9 <= torques_nm) & (torques_nm <= high + 1e-9)).all()
        largest = np.maximum(largest, np.abs(torques_nm))
    assert (largest > 0.5 * high).all()
