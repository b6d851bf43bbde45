"""An actuation model that is added is a record, `build` and `bind`: nothing else knows of it."""

import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import mimoc
from mimoc.actuation.commands import Commands, command_range, find_actuators, limits_of_motors, mean_effort
from mimoc.actuation.setup import ActuationSetup, Origin
from mimoc.compiler.explain import explain
from mimoc.kinds import ActuationKind
from mimoc.mjcf.infant import Actuator
from mimoc.schema.base import Model


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


class Weak(Commands):
    """Commands in [-1, 1]."""

    def effort(self, data):
        return mean_effort(data.actuator_force[self.actuators], np.abs(self.limits_nm).max(axis=1))


def bind(entry, model):
    ids = find_actuators(entry, model)
    return Weak(ids, *command_range(entry), limits_of_motors(model, ids))


WEAK = ActuationKind(name="weak", about="Weak motors.", build=build, run=bind, spec=WeakSpec)


def infant(model, **actuation):
    data = {"mimoc": 1, "name": "x", "age_months": 6, "actuation": {"model": model, **actuation}}
    return mimoc.build(mimoc.InfantSpec.model_validate({**data, "senses": {"proprioception": {}}}))


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


def test_strength_follows_what_was_asked(weak):
    for joint, limits_nm in mimoc.torque_limits(weak).items():
        assert limits_nm == pytest.approx(0.25 * np.array(mimoc.torque_limits(infant("torque"))[joint])), joint


def test_its_numbers_are_explained_whether_it_says_so_or_not(weak):
    first, second = (actuator.name for actuator in weak.manifest.actuation.actuators[:2])
    assert "as measured" in explain(weak, f"actuator.{first}.forcerange").lines
    assert "set by the actuation model 'weak'" in explain(weak, f"actuator.{second}.forcerange").lines
    assert not [line for line in explain(weak, "actuator.act:left_elbow.gear").lines if "xml" in line]


def test_inverse_dynamics_says_why_it_cannot_use_it(weak):
    env = mimoc.InfantEnv(weak)
    with pytest.raises(mimoc.MimocError, match="which the actuation model 'weak' does not accept"):
        mimoc.InverseDynamics(env.model, env.data, env.manifest)


def test_the_spec_language_knows_it(weak):
    with pytest.raises(mimoc.MimocError, match=r"actuation\.weak\.shar: unknown key; did you mean 'share'"):
        mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 6}).with_(
            actuation={"model": "weak", "weak": {"shar": 1}}
        )
