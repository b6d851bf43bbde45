"""Under `maturing` every muscle and every motor needs time to become active; under `published` motors need none."""

import mujoco
import numpy as np
import pytest

import mimoc
from mimoc.bundle.model import load_model
from mimoc.compiler.explain import explain
from mimoc.compiler.measuring import compile_infant

TIMESTEP_S, EYES_S = 0.005, 0.01


def of_eyes(infant):
    """Return which actuators move eyes, shape (n,)."""
    return np.array(["eye" in infant.actuator(index).name for index in range(infant.nu)])


def spec_of(model, development="maturing", age_months=9.0, **keys):
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "development": development}
    return mimoc.InfantSpec.model_validate({**data, "actuation": {"model": model}, **keys})


@pytest.mark.parametrize("age_months", [0, 9, 24])
@pytest.mark.parametrize(
    ("model", "development", "time_constant_s"),
    [("torque", "maturing", 0.06), ("muscle", "maturing", 0.06), ("muscle", "published", 0.01)],
)
def test_activation_follows_the_command_exponentially(model, development, time_constant_s, age_months):
    infant = compile_infant(spec_of(model, development, age_months))
    data = mujoco.MjData(infant)
    data.ctrl[:] = infant.actuator_ctrlrange[:, 1]
    for step in range(1, 30):
        mujoco.mj_step(infant, data)
        times_s = np.where(of_eyes(infant) & (development == "maturing"), EYES_S, time_constant_s)
        assert data.act == pytest.approx(1 - np.exp(-step * TIMESTEP_S / times_s), rel=1e-9)


def test_published_motors_have_no_activation():
    assert compile_infant(spec_of("torque", "published")).na == 0


@pytest.mark.parametrize("pose", ["supine", "sitting", "standing"])
@pytest.mark.parametrize("model", ["torque", "muscle"])
def test_every_pose_starts_without_activation(model, pose):
    env = mimoc.InfantEnv(mimoc.build(spec_of(model)))
    env.step(env.actuation.high)
    assert env.data.act.all()
    env.reset(options={"pose": pose})
    assert not env.data.act.any()


@pytest.mark.parametrize(("model", "development"), [("torque", "maturing"), ("muscle", "published")])
def test_the_time_constant_is_explained(model, development):
    infant = spec_of(model, development)
    told = explain(mimoc.build(infant), "actuator.dynprm")
    assert told.lines[0] == f"{compile_infant(infant).actuator_dynprm[0, 0]:g} s"
    assert [source.key for source in told.sources] == ["spec.development"]
    assert ("Lin" in told.lines[1]) == (development == "maturing")


def test_a_motor_without_activation_has_no_time_constant_to_explain():
    with pytest.raises(mimoc.MimocError, match="dynprm' is not a number of this bundle"):
        explain(mimoc.build(spec_of("torque", "published")), "actuator.dynprm")


@pytest.mark.parametrize("development", ["maturing", "published"])
def test_motors_for_mimo_act_at_once(development):
    """MIMo's muscle model commands them the torques of muscles whose activation it computes itself."""
    bundle = mimoc.build(spec_of("torque", development), "mimo")
    env = mimoc.InfantEnv(bundle)
    assert env.model.na == 0
    env.step(np.full(env.model.nu, 0.5, np.float32))
    elbow = env.model.actuator("act:left_elbow")
    tone = elbow.biasprm[:3] @ (1, env.data.actuator(elbow.name).length[0], env.data.actuator(elbow.name).velocity[0])
    assert env.data.joint("robot:left_elbow").qfrc_actuator[0] == pytest.approx((0.5 + tone) * elbow.gear[0])
    with pytest.raises(mimoc.MimocError):
        explain(bundle, "actuator.dynprm")


def test_muscles_for_mimo_are_the_infants_own():
    plain, other = (load_model(mimoc.build(spec_of("muscle"), target)) for target in (None, "mimo"))
    assert np.array_equal(other.actuator_dynprm, plain.actuator_dynprm)
    assert other.na == plain.na == plain.nu


STROKES = {"robot:left_elbow": (-30, -90), "robot:left_shoulder_horizontal": (0, 60), "robot:left_knee": (-30, -90)}
"""Start and end, in degrees; the way is 60 degrees at all ages."""


def time_of_stroke_s(infant, stroke):
    """Return how long a joint takes for nine tenths of a stroke, alone in space, with the largest sensible command."""
    joint, (start, end) = infant.joint(stroke), np.deg2rad(STROKES[stroke])
    data = mujoco.MjData(infant)
    driven = infant.actuator_trnid[:, 0]
    low, high = infant.jnt_range[driven].T
    data.qpos[infant.jnt_qposadr[driven]] = np.clip(0.0, low, high)
    data.qpos[joint.qposadr[0]] = start
    own = np.flatnonzero(driven == joint.id)
    if len(own) == 2:
        data.ctrl[own[int(end > start)]] = 1.0
    else:
        middle, half = (low + high) / 2, (high - low) / 2
        data.ctrl[:] = data.act[:] = (data.qpos[infant.jnt_qposadr[driven]] - middle) / half
        data.ctrl[own] = (end - middle[own]) / half[own]
    while abs(data.qpos[joint.qposadr[0]] - start) < 0.9 * abs(end - start):
        mujoco.mj_step(infant, data)
        assert data.time < 1.0
    return data.time


@pytest.mark.full
def test_servos_need_no_activation_to_be_as_slow_as_muscles():
    """On average over joints and ages, though single servos are faster; the target of a servo lags by 30 ms."""
    strokes_s = {
        model: np.mean(
            [time_of_stroke_s(in_space(model, age_months), stroke) for age_months in (0, 6, 18) for stroke in STROKES]
        )
        for model in ("position", "muscle")
    }
    assert strokes_s["position"] > strokes_s["muscle"]


def in_space(model, age_months):
    """Return an infant whose hip is fixed, and which nothing pulls or touches."""
    bundle = mimoc.build(spec_of(model, age_months=age_months))
    infant = mujoco.MjSpec.from_string(bundle.files["infant.xml"].decode(), assets=dict(bundle.files))
    infant.delete(infant.joint("mimo_location"))
    found = infant.compile()
    found.opt.gravity[:] = 0.0
    found.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
    return found
