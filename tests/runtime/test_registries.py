from importlib import import_module
from typing import get_args

import numpy as np

from mimoc.actuation.binding import ACTUATIONS
from mimoc.actuation.spec import ActuationEntry
from mimoc.runtime.check import check_stability
from mimoc.runtime.rollout import POLICIES
from mimoc.senses.binding import SENSES, bind_senses
from mimoc.senses.spec import SensesEntry


def test_every_sense_of_the_manifest_can_be_bound():
    assert list(SENSES) == list(SensesEntry.model_fields)
    assert all(callable(import_module(module).bind) for module in SENSES.values())


def test_every_sense_gives_what_it_says(env):
    """The same whenever it is read, a new array each time, and seen within the spaces it says."""
    for name, sense in bind_senses(env.bundle, env.model).items():
        reading, again = sense(env.data), sense(env.data)
        assert (reading == again).all()
        seen = sense.observe(reading)
        assert seen.keys() == sense.spaces.keys()
        for key, space in sense.spaces.items():
            assert seen[key] in space
            assert np.isfinite(space.low).all()
            assert np.isfinite(space.high).all()
            assert (space.low < space.high).all()
            assert not np.shares_memory(seen[key], reading)
        reading[:] = 0
        assert (sense(env.data) == again).all(), name
        assert len(sense.bodies) == len(reading)
        assert sense.bodies.min() > 0
        assert sense.bodies.max() < env.model.nbody
        sense.close()


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
