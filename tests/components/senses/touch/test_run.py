from collections.abc import Mapping
from itertools import product
from types import SimpleNamespace
from typing import Any

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from hypothesis.extra.numpy import arrays
from support.touch_oracle import points

from mimoc.components.senses.touch import POINTS, SkinEntry, TouchEntry
from mimoc.components.senses.touch.receptors import CELL_STRIDES, _neighbours
from mimoc.components.senses.touch.run import MAX_FORCE_N, Touch, bind

G_M_S2 = 9.81
WORLD = """
<mujoco>
  <option cone="elliptic"/>
  <worldbody><geom name="floor" type="plane" size="1 1 1" {floor}/>{bodies}</worldbody>
</mujoco>
"""
BALL = '<body name="{name}" pos="{pos}" euler="{euler}"><freejoint/><geom size="0.05" mass="1" {geom}/></body>'
BOTTOM = (0, 0, -0.05)


def world(*bodies, floor=""):
    """Return a simulation of some bodies above a floor."""
    model = mujoco.MjModel.from_xml_string(WORLD.format(floor=floor, bodies="".join(bodies)))
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data


def ball(name="ball", pos="0 0 0.049", euler="0 0 0", geom=""):
    """Return a ball of 5 cm and 1 kg; it stands 1 mm in the floor unless it is put elsewhere."""
    return BALL.format(name=name, pos=pos, euler=euler, geom=geom)


def skin(
    data, points_m: Mapping[str, list], spacing_m=0.01, quantity="force_vector_global", response="linear"
) -> Touch:
    """Return the touch of some points of some bodies."""
    parts = tuple(SkinEntry(body=name, points=len(points), spacing_m=spacing_m) for name, points in points_m.items())
    entry = TouchEntry(quantity=quantity, response=response, skin=parts)
    arrays = {POINTS: np.concatenate([np.array(points) for points in points_m.values()])}
    stand_in: Any = SimpleNamespace(arrays=arrays, manifest=SimpleNamespace(prefix=""))
    return bind(entry, data.model, stand_in)


# One thing that touches another.


def test_a_body_at_rest_senses_its_weight():
    data = world('<body name="box" pos="0 0 0.05"><freejoint/><geom type="box" size="0.05 0.05 0.05" mass="2"/></body>')
    corners = list(product((-0.05, 0.05), repeat=3))
    touch = skin(data, {"box": corners})
    mujoco.mj_step(data.model, data, 1000)
    forces = points(touch(data))
    assert forces.sum(axis=0) == pytest.approx([0, 0, 2 * G_M_S2], abs=1e-3)
    below = np.array(corners)[:, 2] < 0
    assert forces[below, 2] == pytest.approx(np.full(4, 2 * G_M_S2 / 4), rel=1e-2)
    assert not forces[~below].any()


def test_a_fingertip_senses_its_share_of_the_weight():
    """A rod that turns about one end, and rests on the floor with the other: half of its weight."""
    rod = """
    <body name="rod" pos="0 0 0.01">
      <joint type="hinge" axis="0 1 0" damping="0.1"/>
      <geom type="box" size="0.1 0.001 0.001" pos="0.1 0 0" mass="0.3" contype="0" conaffinity="0"/>
      <body name="tip" pos="0.2 0 0"><geom size="0.01" mass="1e-6"/></body>
    </body>"""
    data = world(rod)
    touch = skin(data, {"rod": [(0.2, 0, -0.01)], "tip": [(0, 0, -0.01)]})
    mujoco.mj_step(data.model, data, 2000)
    assert points(touch(data))[:, 2] == pytest.approx([0, 0.3 * G_M_S2 / 2], rel=1e-3)


def test_friction_is_sensed_too():
    """A ball that slides along x and y is held back."""
    data = world(ball())
    touch = skin(data, {"ball": [BOTTOM]})
    data.qvel[:2] = 1.0, -0.5
    mujoco.mj_forward(data.model, data)
    (force,) = points(touch(data))
    assert force[:2] / force[2] == pytest.approx(np.array([-1, 0.5]) / np.sqrt(1.25), rel=1e-2)


def test_without_friction_only_the_normal_force_is_sensed():
    """The rows of MuJoCo's forces that follow are then those of the next contact."""
    data = world(ball(geom='condim="1"'), ball("other", "1 0 0.04", geom='condim="1"'), floor='condim="1"')
    forces = points(skin(data, {"ball": [BOTTOM], "other": [BOTTOM]})(data))
    assert forces[:, :2] == pytest.approx(np.zeros((2, 2)), abs=1e-9)
    assert (forces[:, 2] == data.efc_force).all()
    assert forces[1, 2] > forces[0, 2] > 0


def test_a_force_is_sensed_in_the_frame_of_the_body():
    """A ball that lies on its left side is pushed to its right by the floor."""
    data = world(ball(euler="-90 0 0"))
    left = {"ball": [(0, 0.05, 0)]}
    force = skin(data, left, quantity="force_vector")(data)
    pressure = skin(data, left, quantity="normal")(data)
    assert force == pytest.approx([0, -pressure[0], 0], abs=1e-9)


@pytest.mark.parametrize("order", [1, -1])
def test_both_bodies_sense_the_same_contact_each_on_its_own_surface(order):
    """A ball that is 4 mm inside another."""
    data = world(*[ball("low", "0 0 0.5"), ball("high", "0 0 0.596")][::order])
    near_the_surface = [(0, 0, sign * height) for sign in (-1, 1) for height in (0.05, 0.0485, 0.046)]
    touch = skin(data, {"low": near_the_surface, "high": near_the_surface}, response="nearest")
    low, high = (points(touch(data))[touch.receptors.names == name] for name in ("low", "high"))
    assert np.flatnonzero(low.any(axis=1)).tolist() == [3]
    assert np.flatnonzero(high.any(axis=1)).tolist() == [0]
    assert high[0, 2] > 0
    assert (low[3] == -high[0]).all()


def test_a_share_falls_with_the_distance_to_nothing_at_two_spacings():
    data = world(ball())
    row = [(x, 0, -0.05) for x in (0.0, 0.01, -0.015, 0.02, 0.03)]
    forces = points(skin(data, {"ball": row}, spacing_m=0.01)(data))
    assert forces[:, 2] / forces[:, 2].sum() == pytest.approx(np.array([1, 0.5, 0.25, 0, 0]) / 1.75, abs=1e-9)
    assert forces.sum() == pytest.approx(data.efc_force[0])


def test_the_nearest_point_alone_can_respond():
    data = world(ball())
    row = [(x, 0, -0.05) for x in (0.006, -0.005, 0.01)]
    forces = points(skin(data, {"ball": row}, response="nearest")(data))
    assert forces[:, 2].tolist() == [0, data.efc_force[0], 0]


@pytest.mark.parametrize("others", [[], [(0, 0, 0.05), (0.05, 0, 0)]])
def test_a_contact_far_from_every_point_goes_to_the_nearest(others):
    """Also where a skin has but one."""
    data = world(ball(), ball("near", "0.2 0 0.5"))
    lonely = (0.03, 0, -0.04)
    forces = points(skin(data, {"ball": [lonely, *others], "near": [BOTTOM]}, spacing_m=0.001)(data))
    assert forces[:, 2].tolist() == [data.efc_force[0], *[0] * len(others), 0]


def test_two_touches_of_one_point_add_up():
    data = world(ball(), ball("above", "0 0 0.148"))
    touch = skin(data, {"ball": [(0, 0, 0)]}, quantity="normal")
    assert touch(data) == pytest.approx([data.efc_force[[0, 3]].sum()])


def test_only_skin_senses():
    """A ball without skin does not, nor does the floor."""
    data = world(ball(), ball("toy", "1 0 0.049"), ball("next", "0.91 0 0.049"))
    touch = skin(data, {"ball": [BOTTOM]})
    assert data.ncon == 4
    assert points(touch(data))[0, 2] == pytest.approx(data.efc_force[0])


def test_what_is_only_near_is_not_sensed():
    """MuJoCo lists such contacts, but not among those that push; which they are, 3.17 sees another way."""
    gaps = [world(ball(pos="0 0 0.055"), floor=f'margin="{margin_m}" gap="0.01"') for margin_m in (0.01, 0)]
    data = next(data for data in gaps if (data.contact.efc_address == -1).any())
    assert not skin(data, {"ball": [BOTTOM]})(data).any()


def test_cloth_is_sensed():
    """It has no geoms: MuJoCo counts it as geom -1, which is not the last one."""
    cloth = """<flexcomp name="cloth" type="grid" dim="2" count="3 3 1" spacing="0.1 0.1 0.1" radius="0.005" mass="1"
               pos="0 0 0.5"><contact selfcollide="none"/></flexcomp>"""
    data = world(cloth, ball(pos="0 0 0.553"), ball("last", "1 0 0.5"))
    assert (data.contact.geom == -1).any()
    low, last = points(skin(data, {"ball": [BOTTOM], "last": [BOTTOM]})(data))
    assert low[2] > 0
    assert not last.any()


def test_no_touch_is_all_zeros():
    data = world(ball(pos="0 0 1"))
    sample = skin(data, {"ball": [BOTTOM, (0, 0, 0.05)]})(data)
    assert sample.shape == (6,)
    assert not sample.any()


@pytest.mark.parametrize(("quantity", "low"), [("force_vector", -MAX_FORCE_N), ("normal", 0)])
@pytest.mark.parametrize("force_n", [1e6, -1e6])
def test_what_is_observed_keeps_to_its_bounds(quantity, low, force_n):
    touch = skin(world(ball()), {"ball": [BOTTOM]}, quantity=quantity)
    sample = np.full(touch.spaces["touch"].shape, force_n)
    observed = touch.observe(sample)["touch"]
    assert observed in touch.spaces["touch"]
    assert (observed == np.clip(force_n, low, MAX_FORCE_N)).all()


def test_the_points_of_a_body_are_counted():
    data = world(ball(), ball("other", "1 0 1"))
    touch = skin(data, {"ball": [BOTTOM, BOTTOM], "other": [BOTTOM]})
    assert touch.layout[2:5] == ("ball 0 world z [N]", "ball 1 world x [N]", "ball 1 world y [N]")
    assert touch.layout[6] == "other 0 world x [N]"


places = arrays(float, st.tuples(st.integers(1, 12), st.just(3)), elements=st.floats(-3, 3, width=32))


def distance_of_cell(place: np.ndarray, corner: np.ndarray) -> float:
    """Return the distance of a place from a cube of one unit."""
    return float(np.linalg.norm(np.maximum(np.maximum(corner - place, place - corner - 1), 0)))


@settings(max_examples=8)
@given(places)
def test_a_cell_lists_in_order_all_receptors_within_one_unit_of_it(scaled):
    scaled = np.add(scaled, (1e3, 0, 0))
    cells, table = _neighbours(scaled)
    listed = {
        cell: [each for each in row if each < len(scaled)] for cell, row in zip(cells, table.tolist(), strict=False)
    }
    assert [*cells] == sorted(listed)
    assert (table[-1] == len(scaled)).all()
    for corner in product(*(np.arange(start - 4.0, start + 5.0) for start in (1e3, 0, 0))):
        distances = [distance_of_cell(place, np.array(corner)) for place in scaled]
        near = [index for index, distance in enumerate(distances) if distance < 1 - 1e-9]
        found = listed.get(float(np.array(corner) @ CELL_STRIDES), [])
        assert near == [index for index in found if distances[index] < 1 - 1e-9]
        assert all(distances[index] < 1 + 1e-9 for index in found)
