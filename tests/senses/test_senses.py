"""What holds of every sense."""

import numpy as np

from mimoc.kinds import function_of
from mimoc.senses import SENSES
from mimoc.senses.binding import bind_senses
from mimoc.senses.spec import SensesEntry, SensesSpec


def test_every_sense_is_a_section_of_the_spec_and_of_the_manifest_and_can_be_built_and_bound():
    assert list(SENSES) == list(SensesSpec.model_fields) == list(SensesEntry.model_fields)
    for kind in SENSES.values():
        assert callable(function_of(kind.build, "build"))
        assert callable(function_of(kind.run, "bind"))


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
