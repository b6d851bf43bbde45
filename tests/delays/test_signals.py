"""Signals with a delay come out in their order, as many items later as the delay has control steps."""

from hypothesis import given, strategies as st

from mimoc.delays.signals import Delay, DelayedSamples

PERIOD = 2


def line(length, sample):
    samples = DelayedSamples(Delay(length * PERIOD), PERIOD)
    samples.reset(sample)
    return samples


def sent(samples, items):
    arrived = []
    for item in items:
        samples.send(item)
        arrived.append(samples.arrived)
    return arrived


@given(st.integers(0, 20), st.lists(st.integers(), max_size=50))
def test_what_goes_in_comes_out_that_much_later(length, items):
    assert sent(line(length, "rest"), items) == (["rest"] * length + items)[: len(items)]


@given(st.integers(0, 5), st.lists(st.integers(), max_size=10), st.lists(st.integers(), max_size=10))
def test_a_line_goes_on_from_what_another_held(length, before, after):
    one, other = line(length, 0), line(length, -1)
    sent(one, before)
    other.state = one.state
    assert sent(one, after) == sent(other, after)


def test_a_state_is_a_list_of_its_own():
    samples = line(2, "rest")
    samples.state[0].clear()
    assert samples.state[0] == ["rest"] * 3
