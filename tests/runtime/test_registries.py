from typing import get_args

from mimoc.runtime.actuation import ACTUATIONS
from mimoc.runtime.check import check_stability
from mimoc.runtime.rollout import POLICIES
from mimoc.runtime.senses import SENSES
from mimoc.schema.manifest import ActuationEntry, SensesEntry


def test_every_sense_of_the_manifest_can_be_bound():
    assert list(SENSES) == list(SensesEntry.model_fields)


def test_every_sense_gives_what_it_says(env):
    """As many finite numbers as it has names and bounds for, a new array each time, and the bounds hold."""
    for kind, entry in env.manifest.senses:
        sense = SENSES[kind](entry, env.manifest.actuation, env.model)
        reading, again = sense(env.data), sense(env.data)
        assert reading.shape == sense.low.shape == sense.high.shape == (len(sense.layout),)
        assert (sense.low < sense.high).all()
        assert (sense.low <= reading).all()
        assert (reading <= sense.high).all()
        assert (reading == again).all()
        reading[:] = 0
        assert (sense(env.data) == again).all()


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
        act = policy(env)
        assert all(act(env.np_random) in env.action_space for _ in range(20))


def test_every_pose_of_the_manifest_is_checked(bundle):
    assert [check.pose for check in check_stability(bundle)] == list(bundle.manifest.poses)
