from hypothesis import given, strategies as st

from mimoc.runtime.noise.noise import NoiseStreams

channels = st.sampled_from(["motor", "touch", "jitter.touch", "jitter.motor", "proprioception"])


@given(st.integers(-1, 2**128 - 1), st.lists(channels, max_size=10), channels)
def test_what_other_channels_draw_changes_nothing(seed, others, channel):
    alone, among = NoiseStreams(seed), NoiseStreams(seed)
    for other in others:
        if other != channel:
            among[other].random(3)
    assert alone[channel].random(5).tolist() == among[channel].random(5).tolist()


@given(st.integers(0, 99), st.lists(channels, max_size=5), st.lists(channels, min_size=1, max_size=5))
def test_streams_go_on_from_a_state_whatever_was_drawn_in_between(seed, before, after):
    streams = NoiseStreams(seed)
    for channel in before:
        streams[channel].random()
    state = streams.state
    drawn = [streams[channel].random() for channel in after]
    other = NoiseStreams(seed + 1)
    other["motor"].random()
    for each in (streams, other):
        each.state = state
        assert [each[channel].random() for channel in after] == drawn


def test_seeds_and_channels_differ():
    one, other = NoiseStreams(1), NoiseStreams(2)
    assert len({one["touch"].random(), one["motor"].random(), other["touch"].random()}) == 3
