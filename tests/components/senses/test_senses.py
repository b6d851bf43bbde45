"""What holds of every sense."""

import numpy as np

from mimoc.base.kinds import function_of
from mimoc.runtime.senses import bind_senses
from mimoc.schema.components.senses import SENSES
from mimoc.schema.senses import SensesEntry, SensesSpec


def test_every_sense_is_a_section_of_the_spec_and_of_the_manifest_and_can_be_built_and_bound():
    assert list(SENSES) == list(SensesSpec.model_fields) == list(SensesEntry.model_fields)
    for kind in SENSES.values():
        assert callable(function_of(kind.build, "build"))
        assert callable(function_of(kind.run, "bind"))


def test_every_sense_returns_what_it_declares(env):
    """The same whenever it is sampled, a new array each time, and observed within the spaces that it declares."""
    for name, sense in bind_senses(env.bundle, env.model).items():
        sample, again = sense(env.data), sense(env.data)
        assert (sample == again).all()
        observed = sense.observe(sample)
        assert observed.keys() == sense.spaces.keys()
        for key, space in sense.spaces.items():
            assert observed[key] in space
            assert np.isfinite(space.low).all()
            assert np.isfinite(space.high).all()
            assert (space.low < space.high).all()
            assert not np.shares_memory(observed[key], sample)
        sample[:] = 0
        assert (sense(env.data) == again).all(), name
        assert sense.bodies is not None
        assert len(sense.bodies) == len(sample)
        assert sense.bodies.min() > 0
        assert sense.bodies.max() < env.model.nbody
        sense.close()
