from typing import get_args

import pytest

from mimoc.bundle.model import load_model
from mimoc.policies.named import policy_of
from mimoc.policies.spec import needs_argument
from mimoc.runtime.actuation import bind_actuation
from mimoc.runtime.check import check_stability
from mimoc.schema.actuation import ActuationEntry
from mimoc.schema.components.actuation import ACTUATIONS
from mimoc.schema.components.policies import POLICIES


def test_every_actuation_of_the_manifest_is_in_the_table():
    assert list(ACTUATIONS) == list(get_args(ActuationEntry.model_fields["model"].annotation))


@pytest.mark.parametrize("model", ACTUATIONS)
def test_every_actuation_says_its_range(built, model):
    bundle = built(actuation={"model": model})
    actuation = bind_actuation(bundle.manifest.actuation, load_model(bundle))
    actuators = bundle.manifest.actuation.actuators
    assert list(actuation.low) == [actuator.action_low for actuator in actuators]
    assert list(actuation.high) == [actuator.action_high for actuator in actuators]


@pytest.mark.parametrize("name", [name for name, kind in POLICIES.items() if not needs_argument(kind)])
def test_every_policy_acts_within_the_space(env, name):
    act, (observation, _) = policy_of(env, name), env.reset()
    assert all(act(env.np_random, observation) in env.action_space for _ in range(20))


def test_every_pose_of_the_manifest_is_checked(bundle):
    assert [check.pose for check in check_stability(bundle)] == list(bundle.manifest.poses)
