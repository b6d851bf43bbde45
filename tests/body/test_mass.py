import mujoco
import pytest
from hypothesis import given
from hypothesis import strategies as st

from mimoc.body.mass import volume

sizes_m = st.floats(0.001, 0.2)


@pytest.mark.matrix
@pytest.mark.parametrize(("kind", "count"), [("sphere", 1), ("capsule", 2), ("cylinder", 2), ("box", 3)])
@given(data=st.data())
def test_volumes_are_mujocos(kind, count, data):
    """At one kilogram a cubic metre the mass MuJoCo computes is the volume."""
    size_m = tuple(data.draw(st.lists(sizes_m, min_size=count, max_size=count)))
    written = " ".join(map(repr, size_m))
    xml = f'<mujoco><worldbody><body><geom type="{kind}" size="{written}" density="1"/></body></worldbody></mujoco>'
    assert volume(kind, size_m) == pytest.approx(mujoco.MjModel.from_xml_string(xml).body_mass[1])
