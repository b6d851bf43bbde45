from typing import get_args

from mimoc.actuation import ACTUATIONS
from mimoc.actuation.spec import ActuationEntry
from mimoc.runtime.check import check_stability
from mimoc.runtime.rollout import POLICIES


def test_every_actuation_of_the_manifest_can_be_bound():
    assert list(ACTUATIONS) == list(get_args(ActuationEntry.model_fields["model"].annotation))


def test_every_actuation_says_its_range(env):
    for bind in ACTUATIONS.values():
        actuation = bind(env.manifest.actuation, env.model)
        actuators = env.manifest.actuation.actuators
        assert list(actuation.low) == [actuator.action_low for actuator in actuators]
        assert list(actuation.high) == [actuator.action_high for actuator in actuators]


def test_every_policy_acts_within_the_space(env):
    for policy in POLICIES.values():
        act, (observation, _) = policy(env), env.reset()
        assert all(act(env.np_random, observation) in env.action_space for _ in range(20))


def test_every_pose_of_the_manifest_is_checked(bundle):
    assert [check.pose for check in check_stability(bundle)] == list(bundle.manifest.poses)
