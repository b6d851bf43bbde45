"""An actuation model that is added is a record, `build` and `bind`: nothing else knows of it."""

from dataclasses import replace

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import mimoc
from mimoc.bundle.model import load_model
from mimoc.compiler.actuation import ActuationSetup, Origin
from mimoc.compiler.explain import explain
from mimoc.compiler.mjcf.elements import Actuator
from mimoc.runtime.actuation import Actuation, command_range, effort_of, find_actuators, limits_of_motors
from mimoc.runtime.term import Field
from mimoc.schema.base import Model
from mimoc.schema.kinds import ActuationKind

TINY = {"n_steps": 32, "batch_size": 64, "n_epochs": 1, "width": 8, "layers": 1}


class WeakSpec(Model):
    """Motors with a share of their strength."""

    share: float = 0.5
    """Of the strength of torque motors."""


def build(spec, tree, timestep_s):
    """Return weak motors; only the first says where its numbers come from."""
    motors = tuple(
        Actuator(
            name=f"{motor.name}_weak",
            mimo_actuator=motor.name,
            joint=motor.joint,
            gear=spec.share * motor.gear_nm,
            control_range=(-1.0, 1.0),
            settings=(("forcerange", motor.force_range),),
        )
        for motor in tree.motors
    )
    defaults = (("forcelimited", "true"), ("gaintype", "fixed"), ("gainprm", "1"), ("biastype", "none"))
    origins = {f"actuator.{motors[0].name}.forcerange": Origin("as measured", ("spec.age_months",), "1")}
    return ActuationSetup(motors, defaults, "Euler", tree.joints, origins=origins)


def bind(entry, model):
    """Commands in [-1, 1]."""
    ids = find_actuators(entry, model)
    limits_nm, drive = limits_of_motors(model, ids), Field("ctrl", ids)
    return Actuation(ids, *command_range(entry), limits_nm, effort_of(Field("actuator_force", ids), limits_nm), drive)


WEAK = ActuationKind(name="weak", about="Weak motors.", build=build, run=bind, spec=WeakSpec)


def build_tripled(spec, tree, timestep_s):
    """Return motors of three times their strength, without a force range."""
    motors = build(WeakSpec(share=1.0), tree, timestep_s).actuators
    unlimited = tuple(replace(motor, settings=()) for motor in motors)
    defaults = (("forcelimited", "false"), ("gaintype", "fixed"), ("gainprm", "3"), ("biastype", "none"))
    return ActuationSetup(unlimited, defaults, "Euler", tree.joints)


def bind_tripled(entry, model):
    """Motors whose gain is not 1."""
    ids = find_actuators(entry, model)
    strengths_nm = 3 * model.actuator_gear[ids, 0]
    limits_nm, drive = np.stack([-strengths_nm, strengths_nm], axis=1), Field("ctrl", ids)
    return Actuation(ids, *command_range(entry), limits_nm, effort_of(drive, limits_nm), drive, "excitation")


def infant(model, keys=None, target=None, **actuation):
    data = {"mimoc": 1, "name": "x", "age_months": 18, "actuation": {"model": model, **actuation}}
    spec = {**data, "senses": {"proprioception": {}}, **(keys or {})}
    return mimoc.build(mimoc.InfantSpec.model_validate(spec), target)


@pytest.fixture
def weak(registered):
    with registered(WEAK):
        yield infant("weak", weak={"share": 0.25})


def test_it_is_built_run_and_checked(weak):
    env = mimoc.InfantEnv(weak)
    check_env(env, skip_render_check=True)
    env.reset(seed=0)
    env.step(env.action_space.high)
    assert 0 < env.effort() < 1


@pytest.mark.full
def test_strength_follows_what_was_asked(weak):
    for joint, limits_nm in mimoc.torque_limits(weak).items():
        assert limits_nm == pytest.approx(0.25 * np.array(mimoc.torque_limits(infant("torque"))[joint])), joint


def test_its_numbers_are_explained_whether_it_says_so_or_not(weak):
    first, second = (actuator.name for actuator in weak.manifest.actuation.actuators[:2])
    assert "as measured" in explain(weak, f"actuator.{first}.forcerange").lines
    assert "set by the actuation model 'weak'" in explain(weak, f"actuator.{second}.forcerange").lines
    assert not [line for line in explain(weak, "actuator.act:left_elbow.gear").lines if "xml" in line]


def test_proprioception_asks_it_for_its_drive(registered):
    """Here nothing in the MJCF limits the torque, and the bounds of the observation are the same at every age."""
    tripled = replace(WEAK, name="tripled", build=build_tripled, run=bind_tripled, spec=None)
    with registered(tripled):
        senses = {"proprioception": {"include": ["actuation"]}}
        env = mimoc.InfantEnv(infant("tripled", {"senses": senses}, regions=["arms"]))
        env.reset(seed=0)
        sensed = env.step(env.action_space.high)[0]["proprioception"]
        layout = env.layout("proprioception")
        gears_nm = [env.model.actuator(each.name).gear[0] for each in env.manifest.actuation.actuators]
        drives = [index for index, name in enumerate(layout) if name.endswith("excitation [1]")]
        torques = [index for index, name in enumerate(layout) if name.endswith("torque [N m]")]
        assert len(drives) == len(torques) == len(env.manifest.actuation.actuators)
        commanded = [actuator.commanded for actuator in env.manifest.actuation.actuators]
        assert sensed[drives].tolist() == [float(each) for each in commanded]
        assert sensed[torques] == pytest.approx(np.where(commanded, 3 * np.array(gears_nm), 0.0))


@pytest.mark.extras
@pytest.mark.slow
def test_a_policy_is_trained_with_it(registered, tmp_path):
    with registered(WEAK):
        reaching = infant("weak", {"task": {"kind": "reach", "steps": 30}})
        options = {"steps": 64, "envs": 2, "checkpoint_every": 64, "hyper": TINY, "processes": False}
        training = mimoc.train(reaching, tmp_path / "run", **options)
        (episode,) = mimoc.evaluate(mimoc.make(reaching), mimoc.load_policy(training.policy), episodes=1)
    assert 0 < episode.steps <= 30


def test_it_can_be_built_for_mimos_code(weak):
    """Which gets its actuators as they are."""
    model, other = load_model(weak), load_model(infant("weak", target="mimo", weak={"share": 0.25}))
    names = [model.actuator(index).name for index in range(model.nu)]
    assert [other.actuator(name).gear[0] for name in names] == [model.actuator(name).gear[0] for name in names]


def test_inverse_dynamics_says_why_it_cannot_use_it(weak):
    env = mimoc.InfantEnv(weak)
    with pytest.raises(mimoc.MimocError, match="which the actuation model 'weak' does not accept"):
        mimoc.InverseDynamics(env.model, env.data, env.manifest)


def test_the_spec_language_knows_it(weak):
    with pytest.raises(mimoc.MimocError, match=r"actuation\.weak\.shar: unknown key; did you mean 'share'"):
        mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 6}).with_(
            actuation={"model": "weak", "weak": {"shar": 1}}
        )
