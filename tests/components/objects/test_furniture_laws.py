"""Whatever the size of furniture: nothing begins in anything, all rests, and MuJoCo warns of nothing."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.furnished import furnished

PLACES = [{"x_cm": 600, "y_cm": 0}, {"x_cm": -600, "y_cm": 0}, {"x_cm": 0, "y_cm": 600}, {"x_cm": 0, "y_cm": -600}]
"""So far apart that no two pieces of furniture touch."""

lengths = st.floats(10, 200)
sides = st.tuples(lengths, lengths)
looks = st.fixed_dictionaries({"yaw_deg": st.floats(-180, 180)})
gratings = st.fixed_dictionaries({"cpd": st.floats(0.1, 1), "contrast": st.floats(0, 1)})
FURNITURE = {
    "mat": {"sides_cm": sides, "thickness_cm": st.floats(0.5, 50), "sink_cm": st.floats(0.05, 3)},
    "table": {"sides_cm": sides, "top_cm": st.floats(5, 120)},
    "rail": {"width_cm": lengths, "bar_cm": st.floats(5, 100)},
    "stairs": {
        "steps": st.integers(1, 20),
        "rise_cm": st.floats(1, 30),
        "run_cm": st.floats(5, 25),
        "width_cm": lengths,
    },
    "slope": {"angle_deg": st.floats(0, 40), "length_cm": lengths, "width_cm": lengths},
    "wall": {"width_cm": lengths, "tall_cm": lengths, "thickness_cm": st.floats(1, 50), "grating": gratings},
    "screen": {
        "width_cm": lengths,
        "tall_cm": st.floats(10, 100),
        "middle_cm": st.floats(50, 200),
        "grating": gratings,
    },
    "seat": {"recline_deg": st.floats(15, 60), "seat_cm": st.floats(50, 100)},
}
"""Sizes of each kind that a spec can ask for, up to what fits between the others."""
BEARS = ("mat", "table")
THINGS = [
    {"shape": "sphere", "radius_cm": 3},
    {"shape": "box", "sides_cm": [5, 4, 3]},
    {"shape": "cylinder", "radius_cm": 3, "length_cm": 6},
    {"toy": "cup", "size_cm": 7},
]


@st.composite
def rooms(draw):
    """Return the objects of a scene, and where its infant starts."""
    kinds = draw(st.lists(st.sampled_from(sorted(FURNITURE)), min_size=1, max_size=4))
    objects = []
    for number, (kind, place) in enumerate(zip(kinds, PLACES, strict=False)):
        item = {"name": f"{kind}{number}", "kind": kind, "at": place}
        objects.append(item | draw(looks) | {key: draw(value) for key, value in FURNITURE[kind].items()})
        if kind in BEARS:
            objects.append({"name": f"thing{number}", "at": f"on {item['name']}", **draw(st.sampled_from(THINGS))})
    starts = {
        "floor": ([], {"pose": draw(st.sampled_from(["supine", "prone"]))}),
        "mat": ([{"name": "start", "kind": "mat", "thickness_cm": draw(st.floats(1, 30))}], {"start_at": "start"}),
        "slope": ([{"name": "start", "kind": "slope", "angle_deg": draw(st.floats(0, 20))}], {"start_at": "start"}),
        "seat": (
            [{"name": "start", "kind": "seat", "recline_deg": draw(st.floats(25, 60))}],
            {"start_at": "start", "pose": "sitting"},
        ),
    }
    first, scene = starts[draw(st.sampled_from(sorted(starts)))]
    return [*first, *objects], scene


@pytest.mark.full
@settings(max_examples=30)
@given(rooms(), st.sampled_from([0, 4, 9, 16, 24]))
def test_random_furniture_is_stood_on_and_rests(room, age_months):
    objects, scene = room
    start = furnished(objects, age_months, **scene)
    assert start.deepest_m() < 2e-4
    things = [item["name"] for item in objects if item["name"].startswith("thing")]
    before = start.place("hip", *(f"object_{name}" for name in things))
    start.run(2)
    assert np.linalg.norm(start.place("hip") - before[:1]) < 0.03, "it sinks in by 5 mm, the youngest roll a little"
    for name in things:
        speed = np.abs(start.data.joint(f"object_{name}_free").qvel)
        assert speed[:3].max() < 0.02, name
        assert speed[3:].max() < 0.1, "what is slender sways on a soft mat for some seconds"
    moved_m = np.linalg.norm((start.place("hip", *(f"object_{name}" for name in things)) - before)[1:], axis=1)
    assert (moved_m < 0.031).all(), "nothing but foam gives way"
