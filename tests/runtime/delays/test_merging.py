"""Control steps of several infants side by side."""

from itertools import pairwise

from hypothesis import given, strategies as st

from mimoc.runtime.control_step import merge_segments
from mimoc.runtime.delays.schedule import Segment

CUTS = st.lists(st.integers(1, 9), unique=True).map(sorted)


def segments(cuts: list[int]) -> list[Segment]:
    """Return the segments of a control step of ten physics steps that is cut at some of them."""
    return [Segment((), end - start, ()) for start, end in pairwise([0, *cuts, 10])]


@given(st.dictionaries(st.sampled_from(["anna", "ben", "kim"]), CUTS, min_size=1))
def test_every_segment_begins_and_ends_once_at_its_time(infants):
    of_infants = {name: segments(cuts) for name, cuts in infants.items()}
    time, begun, ended = 0, {name: [] for name in infants}, {name: [] for name in infants}
    for part in merge_segments(of_infants):
        for name, segment in part.begun:
            assert time == sum(earlier.physics_steps for earlier in begun[name])
            begun[name].append(segment)
        assert part.physics_steps > 0
        time += part.physics_steps
        for name, segment in part.ended:
            ended[name].append(segment)
            assert time == sum(earlier.physics_steps for earlier in ended[name])
    assert time == 10
    assert begun == ended == of_infants
