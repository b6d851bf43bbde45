"""What senses of others must return, and how they are told when they do not."""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from gymnasium.spaces import Box
from support.worlds import ANNA, BEN, world

import mimoc
from mimoc.base.errors import KindError
from mimoc.base.kinds import function_of
from mimoc.runtime.contract import check_observation
from mimoc.runtime.sense import TermSense, Vector, bind_senses, check_sense
from mimoc.runtime.term import Term
from mimoc.schema.kinds import SENSES
from mimoc.schema.senses import SensesEntry, SensesSpec

UNIT = Box(0.0, 1.0, (3,), np.float32)
PLAIN = mimoc.InfantSpec(mimoc=1, name="a", age_months=9, senses={"vestibular": {}})
PICTURE = Box(0, 255, (2, 2, 3), np.uint8)


@pytest.fixture(scope="module")
def opened() -> mimoc.Bundle:
    """Return an infant, built once."""
    return mimoc.build(PLAIN)


class Given:
    """A sense that returns what it was given."""

    def __init__(self, sample: Any, space: Box = UNIT):
        self.sample, self.space = sample, space

    def __call__(self, data: Any) -> Any:
        return self.sample


@pytest.mark.parametrize(
    ("sense", "given"),
    [
        (Given(np.zeros(4)), r"an array of float64, shape \(4,\)"),
        (Given(np.zeros((1, 3))), r"an array of float64, shape \(1, 3\)"),
        (Given(0.5), "0.5"),
        (Given(None), "None"),
        (Given([[1.0], [1.0, 2.0]]), r"\[\[1.0\], \[1.0, 2.0\]\]"),
        (Given(np.zeros(3, int)), r"an array of int64, shape \(3,\)"),
        (Given(np.zeros(3, complex)), r"an array of complex128, shape \(3,\)"),
        (Given(np.array(["a", "b", "c"])), r"an array of <U1, shape \(3,\)"),
        (Given(np.zeros((2, 2, 3)), PICTURE), r"an array of float64, shape \(2, 2, 3\)"),
        (Given(np.zeros(12, np.uint8), PICTURE), r"an array of uint8, shape \(12,\)"),
    ],
)
def test_a_sample_has_the_shape_and_the_type_of_its_space(opened, sense, given):
    expected = rf"sense 'sound' \(.*test_contract:Given\): its sample is {given}; expected an array of "
    with pytest.raises(KindError, match=rf"^{expected}{sense.space.dtype}, shape \({sense.space.shape[0]},"):
        mimoc.make(opened, senses={"sound": sense})


def test_a_sample_has_no_nan_when_an_environment_is_opened(opened):
    with pytest.raises(KindError, match=r"sense 'sound' \(.*:Given\): its sample has a NaN"):
        mimoc.make(opened, senses={"sound": Given(np.array([0.0, np.nan, 1.0]))})


@pytest.mark.parametrize("sample", [np.array([-2.0, 0.5, 7.0]), [-2.0, 0.5, 7.0], np.float32([-2.0, 0.5, 7.0])])
def test_what_is_outside_of_a_space_is_clipped_and_precision_is_cast(opened, sample):
    env = mimoc.make(opened, senses={"sound": Given(sample)})
    observed = env.reset(seed=0)[0]["sound"]
    assert (observed.dtype, observed.tolist()) == (np.float32, [0.0, 0.5, 1.0])


def test_worlds_and_batches_hold_senses_to_the_same(opened):
    bad = Given(np.zeros(4))
    with pytest.raises(KindError, match=r"sense 'sound' \(.*:Given\): its sample is"):
        mimoc.make_vec(opened, 2, senses={"sound": bad})
    with pytest.raises(KindError, match=r"sense 'sound' \(.*:Given\): its sample is"):
        mimoc.make_parallel(world(anna=ANNA, ben=BEN), senses={"ben": {"sound": bad}})


class Echo(Vector):
    """A sense of a plug-in, of two numbers."""

    def __init__(self, sample: Any):
        super().__init__("echo", ("a [1]", "b [1]"), low=0.0, high=1.0)
        self.sample = sample

    def __call__(self, data: Any) -> Any:
        return self.sample


@pytest.mark.parametrize("sample", [0.5, np.zeros(1), np.zeros(3), np.zeros((1, 2)), np.zeros(2, int)])
def test_a_vector_of_a_plug_in_is_as_long_as_it_says_before_it_is_broadcast(sample):
    with pytest.raises(KindError, match=r"sense 'echo' \(.*test_contract:Echo\): its sample is"):
        check_sense("echo", Echo(sample), sample)
    check_sense("echo", Echo(np.zeros(2)), np.zeros(2))


class Other(Echo):
    """One that observes something else than it says."""

    def observe(self, sample: Any) -> Any:
        return self.sample


@pytest.mark.parametrize(
    ("observed", "told"),
    [
        (None, "observe() returns None; expected echo"),
        ({"ecco": np.zeros(2, np.float32)}, "observe() returns ecco; expected echo"),
        ({"echo": np.zeros(2)}, "'echo' in its observation is an array of float64, shape (2,)"),
        ({"echo": np.zeros(3, np.float32)}, "'echo' in its observation is an array of float32, shape (3,)"),
        ({"echo": np.float32([0, np.nan])}, "'echo' in its observation has a NaN"),
    ],
)
def test_an_observation_is_exactly_as_the_spaces_say(observed, told):
    with pytest.raises(KindError) as raised:
        check_sense("echo", Other(observed), np.zeros(2))
    assert told in str(raised.value)
    check_observation("sense", {"echo": np.zeros(2, np.float32)}, Echo(0).spaces)


@dataclass(frozen=True)
class Flat(Term):
    """A term that forgets the axis of infants."""

    def __call__(self, worlds: Any) -> Any:
        return worlds.xpos[0, 1, :2]


@dataclass(frozen=True)
class First(Term):
    """A term that measures the first infant only."""

    def __call__(self, worlds: Any) -> Any:
        return worlds.xpos[:1, 1, :]


class Termed:
    """A sense that is a term."""

    space = Box(-9.0, 9.0, (3,), np.float32)

    def __init__(self, term: Term):
        self.term = term


def test_a_term_measures_a_row_of_each_infant(opened):
    with pytest.raises(KindError, match=r"the term .*test_contract:Flat returns an array of float64, shape \(2,\)"):
        mimoc.make(opened, senses={"flat": Termed(Flat())})
    envs = mimoc.make_vec(opened, 2, senses={"first": Termed(First())})
    envs.reset(seed=0)
    with pytest.raises(
        KindError, match=r"sense 'first': the term .*:First returns an array of float64, shape \(1, 3\)"
    ):
        envs.step(envs.action_space.sample())
    envs.close()


def test_the_class_of_a_term_is_told(opened):
    sense = TermSense("first", First(), ("a [m]",), low=-9.0, high=9.0)
    data = mimoc.make(opened).unwrapped.data
    with pytest.raises(KindError, match=r"sense 'first' \(.*test_contract:First\): its sample is an array of float64"):
        check_sense("first", sense, sense(data))


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
