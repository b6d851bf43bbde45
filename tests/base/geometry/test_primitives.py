import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st

from mimoc.base.geometry.primitives import area, depths, extents, outward, volume

SIZES = {"sphere": 1, "capsule": 2, "cylinder": 2, "ellipsoid": 3, "box": 3}
"""How many numbers each kind has."""
lengths = st.floats(0.02, 0.2)
primitives = st.sampled_from(sorted(SIZES)).flatmap(
    lambda kind: st.tuples(st.just(kind), st.tuples(*[lengths] * SIZES[kind]))
)
units = st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.01)
units = units.map(lambda v: np.array(v) / np.linalg.norm(v))

DIAGONAL = 1 / np.sqrt(3)
REACHES = {
    "a ball, its radius": ("sphere", (0.1,), (1, 0, 0), 0.1),
    "a capsule, its axis and cap": ("capsule", (0.1, 0.3), (0, 0, 1), 0.4),
    "a capsule across, its radius": ("capsule", (0.1, 0.3), (1, 0, 0), 0.1),
    "a cylinder, its axis": ("cylinder", (0.1, 0.3), (0, 0, -1), 0.3),
    "a cylinder across, its radius": ("cylinder", (0.1, 0.3), (0, 1, 0), 0.1),
    "a cylinder at a slant, its rim": ("cylinder", (0.1, 0.3), (0.6, 0, 0.8), 0.3),
    "an ellipsoid, its half axis": ("ellipsoid", (0.1, 0.2, 0.3), (0, -1, 0), 0.2),
    "a box, its corner": ("box", (0.1, 0.2, 0.3), (DIAGONAL, -DIAGONAL, DIAGONAL), 0.6 * DIAGONAL),
}


@pytest.mark.matrix
@pytest.mark.parametrize("kind", SIZES)
@given(data=st.data())
def test_volumes_are_mujocos(kind, data):
    """At one kilogram a cubic metre the mass MuJoCo computes is the volume."""
    size_m = data.draw(st.tuples(*[lengths] * SIZES[kind]))
    written = " ".join(map(repr, size_m))
    xml = f'<mujoco><worldbody><body><geom type="{kind}" size="{written}" density="1"/></body></worldbody></mujoco>'
    assert volume(kind, size_m) == pytest.approx(mujoco.MjModel.from_xml_string(xml).body_mass[1])


@pytest.mark.parametrize("kind", ["sphere", "capsule"])
@given(data=st.data())
def test_what_is_round_has_the_area_that_its_volume_grows_by(kind, data):
    """By its radius: the thin shell around it has its area times the thickness."""
    size = data.draw(st.tuples(*[lengths] * SIZES[kind]))
    thin = 1e-6 * size[0]
    shell = volume(kind, (size[0] + thin, *size[1:])) - volume(kind, size)
    assert area(kind, size) == pytest.approx(shell / thin, rel=1e-4)


@pytest.mark.parametrize(
    ("kind", "size", "wanted"),
    [
        ("box", (0.5, 0.5, 1.0), 10),
        ("sphere", (1.0,), 4 * np.pi),
        ("cylinder", (1.0, 0.5), 4 * np.pi),
        ("capsule", (1.0, 0.5), 6 * np.pi),
    ],
)
def test_the_area_is_that_of_sides_and_ends(kind, size, wanted):
    assert area(kind, size) == pytest.approx(wanted)


@pytest.mark.parametrize("case", REACHES)
def test_a_primitive_reaches(case):
    kind, size, direction, wanted = REACHES[case]
    assert extents([(kind, size)]).along(np.array(direction, float)) == pytest.approx([wanted])


@given(primitive=primitives, direction=units)
def test_mujoco_finds_a_primitive_to_reach_as_far(primitive, direction):
    """A plate across the direction, a millimetre beyond the reach, is a millimetre away."""
    kind, size = primitive
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><worldbody><geom type="{kind}" size="{" ".join(map(repr, size))}"/><body><freejoint/>'
        '<geom name="plate" type="box" size="1 1 .001" mass="1"/></body></worldbody></mujoco>'
    )
    data = mujoco.MjData(model)
    (reach,) = extents([primitive]).along(direction)
    data.qpos[:3] = (reach + 0.002) * direction
    mujoco.mju_quatZ2Vec(data.qpos[3:7], direction)
    mujoco.mj_kinematics(model, data)
    gap = mujoco.mj_geomDistance(model, data, 0, 1, 1.0, None)
    assert gap == pytest.approx(0.001, abs=2e-5)


@given(one=primitives, other=primitives, direction=units)
def test_several_reach_as_far_as_each_does_alone(one, other, direction):
    alone = [extents([each]).along(direction)[0] for each in (one, other)]
    assert extents([one, other]).along(np.stack([direction, direction])) == pytest.approx(alone)


@given(primitive=primitives, direction=units, share=st.floats(0.05, 0.95))
def test_a_point_inside_is_as_deep_as_the_way_out_is_long(primitive, direction, share):
    """Its way out ends on the surface, at right angles to it: beyond, the depth falls as the distance grows."""
    kind, size = primitive
    far = direction * extents([primitive]).along(direction)
    inside = far * share
    (depth,) = depths(kind, size, inside[None])
    if depth <= 1e-6:
        return
    (out,) = outward(kind, size, inside[None])
    assert np.linalg.norm(out) == pytest.approx(1)
    assert depths(kind, size, (inside + depth * out)[None]) == pytest.approx(0, abs=1e-12)
    assert depths(kind, size, (inside + (depth + 0.01) * out)[None]) == pytest.approx(-0.01, abs=1e-12)


@pytest.mark.parametrize("kind", sorted(SIZES))
def test_the_middle_has_a_way_out_too(kind):
    size = (0.1, 0.2, 0.3)[: SIZES[kind]]
    (out,) = outward(kind, size, np.zeros((1, 3)))
    assert np.linalg.norm(out) == pytest.approx(1)
    assert depths(kind, size, 0.1 * out[None]) == pytest.approx(0, abs=1e-12)


@given(primitives, units)
def test_the_farthest_point_is_as_far_as_a_primitive_reaches(primitive, direction):
    found = extents([primitive])
    point = found.farthest(direction[None])[0]
    assert point @ direction == pytest.approx(found.along(direction[None])[0])
