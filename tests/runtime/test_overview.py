import mujoco
import numpy as np
import pytest

from mimoc.runtime.overview import behind_walls_m, overview


@pytest.fixture(scope="module")
def room(built):
    """Return an infant in a room with three toys."""
    return built(scene={"kind": "room", "pose": "sitting", "toys": {"count": [3, 3]}})


def test_toys_and_infant_are_in_the_picture(room, built):
    """It differs where they are from that of the same room without toys."""
    empty = built(scene={"kind": "room", "pose": "sitting"})
    full, bare = overview(room, 160, 120), overview(empty, 160, 120)
    assert full.shape == bare.shape == (120, 160, 3)
    assert not np.array_equal(full, bare)
    assert full.std() > 20


def test_the_same_room_is_the_same_picture(room):
    assert np.array_equal(overview(room, 80, 60), overview(room, 80, 60))


@pytest.mark.parametrize(
    ("place", "behind_m"), [((0, 0, 1), 0), ((1.9, 0, 1), 0), ((2.5, 0, 1), 0.5), ((0, 0, -0.3), 0.3)]
)
def test_a_place_is_as_far_behind_walls_as_behind_the_farthest(place, behind_m):
    """Of a floor and a wall that looks backwards, two metres ahead."""
    planes = '<geom type="plane" size="2 2 1"/><geom type="plane" size="2 2 1" pos="2 0 0" euler="0 -90 0"/>'
    model = mujoco.MjModel.from_xml_string(f'<mujoco><worldbody>{planes}<geom size=".1"/></worldbody></mujoco>')
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    assert behind_walls_m(model, data, np.array(place)) == pytest.approx(behind_m)
