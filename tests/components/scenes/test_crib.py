import itertools
import math

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from mimoc.compiler.mjcf.elements import RAIL_RADIUS_M, WorldGeom
from mimoc.components.scenes.crib import LEGS_M, Crib, crib

LENGTHS = st.floats(0.35, 1.2)
SIDES = ("front", "back", "left", "right")


def geoms(made: Crib, prefix: str) -> list[WorldGeom]:
    return [each for each in made.furniture.geoms if each.name.startswith(prefix)]


def half_extent(each: WorldGeom) -> np.ndarray:
    """Return half of how far a geom reaches along x, y and z."""
    if each.type != "capsule":
        return np.array([*each.size_m[:2], each.size_m[2] if each.type == "box" else 0.0])
    radius, half = each.size_m
    along = [each.euler_rad[1] != 0, each.euler_rad[0] != 0, each.euler_rad == (0, 0, 0)]
    return radius + half * np.array(along)


def compiled(made: Crib, extra: str = "") -> mujoco.MjModel:
    def text(numbers) -> str:
        return " ".join(map(str, numbers))

    solids = "".join(
        f'<geom name="{each.name}" type="{each.type}" size="{text(each.size_m)}" pos="{text(each.pos_m)}" '
        f'euler="{text(each.euler_rad)}" solref="{text(each.solref)}" solimp="{text(each.solimp)}" '
        f'solmix="{each.solmix}" contype="{each.contype}" conaffinity="{each.conaffinity}"/>'
        for each in made.furniture.geoms
    )
    xml = f'<mujoco><compiler angle="radian" eulerseq="xyz"/><worldbody>{solids}{extra}</worldbody></mujoco>'
    return mujoco.MjModel.from_xml_string(xml)


@given(LENGTHS)
def test_the_mattress_is_at_zero_and_fills_the_crib(length):
    made = crib(length)
    (mattress,), (sheet,) = geoms(made, "crib_mattress"), geoms(made, "crib_sheet")
    assert sheet.pos_m[2] == 0
    assert -0.002 < mattress.pos_m[2] + mattress.size_m[2] < 0, "the sheet hides it"
    for each in (mattress, sheet):
        assert [2 * half for half in each.size_m[:2]] == pytest.approx(made.inner_m)
    assert made.inner_m[0] >= 1.2 * length
    assert made.inner_m[1] == 0.6


def test_a_usual_child_has_a_usual_crib():
    assert crib(0.5).inner_m == crib(0.95).inner_m == (1.2, 0.6)


def test_the_rail_is_where_mimo_holds_it_at_eighteen_months():
    made = crib(0.82)
    assert made.rail_height_m - RAIL_RADIUS_M >= 0.42
    assert made.rail_height_m + RAIL_RADIUS_M <= 0.45


@given(LENGTHS)
def test_the_rail_grows_with_the_child_and_goes_all_around(length):
    made = crib(length)
    assert made.rail_height_m == pytest.approx(length * crib(1.0).rail_height_m)
    rails = geoms(made, "crib_rail")
    assert [rail.name for rail in rails] == [f"crib_rail_{side}" for side in SIDES]
    assert all(rail.pos_m[2] == made.rail_height_m for rail in rails)


@given(LENGTHS)
def test_no_head_fits_between_the_bars_and_no_hand_is_stuck(length):
    """EN 716-1: 45 to 65 mm; posts count as bars."""
    made = crib(length)
    for side, axis in zip(SIDES, (1, 1, 0, 0), strict=True):
        bars = geoms(made, f"crib_bar_{side}")
        posts = [post for post in geoms(made, "crib_post") if side in post.name]
        row = sorted(bars + posts, key=lambda each: each.pos_m[axis])
        assert {row[0].name, row[-1].name} == {post.name for post in posts}
        for first, second in itertools.pairwise(row):
            apart = second.pos_m[axis] - first.pos_m[axis]
            assert 0.045 <= apart - half_extent(first)[axis] - half_extent(second)[axis] <= 0.065


@settings(max_examples=40)
@given(LENGTHS)
def test_what_can_be_held_is_round_and_thin(length):
    for each in [*geoms(crib(length), "crib_bar"), *geoms(crib(length), "crib_rail")]:
        assert each.type == "capsule"
        assert 2 * each.size_m[0] <= 0.02


@given(LENGTHS)
def test_bars_end_inside_the_rails(length):
    made = crib(length)
    for bar in geoms(made, "crib_bar"):
        top = bar.pos_m[2] + bar.size_m[1]
        assert top + bar.size_m[0] < made.rail_height_m + RAIL_RADIUS_M
        assert bar.pos_m[2] - bar.size_m[1] < 0
        assert top == pytest.approx(made.rail_height_m)


@given(LENGTHS)
def test_nothing_reaches_into_the_crib_or_below_the_floor(length):
    made = crib(length)
    inner = np.array(made.inner_m) / 2
    for each in made.furniture.geoms:
        half, middle = half_extent(each), np.abs(each.pos_m)
        assert each.pos_m[2] - half[2] >= -LEGS_M - 1e-9
        if not each.name.startswith(("crib_mattress", "crib_sheet")):
            assert (middle[:2] - half[:2] >= inner - 1e-9).any(), each.name


def test_the_crib_is_alike_on_all_four_corners():
    places = {(each.type, *np.round(each.pos_m, 9)) for each in crib(0.7).furniture.geoms}
    assert places == {(kind, -x, y, z) for kind, x, y, z in places} == {(kind, x, -y, z) for kind, x, y, z in places}


def test_names_are_unique_and_every_reference_is_kept():
    furniture = crib(0.7).furniture
    assert len({each.name for each in furniture.geoms}) == len(furniture.geoms)
    assert {each.material for each in furniture.geoms} == {each.name for each in furniture.materials}
    assert {each.texture for each in furniture.textured_materials} == {each.name for each in furniture.textures}


def test_a_crib_is_wider_for_a_child_that_would_reach_through_the_bars():
    assert crib(0.8, (0.4, 0.35)).inner_m == pytest.approx((1.2, 0.72))
    assert crib(0.8, (0.7, 0.2)).inner_m == pytest.approx((1.42, 0.6))


def test_only_the_sheet_of_the_bed_is_felt():
    """On a box, MuJoCo lets cylinders tremble."""
    (sheet,), (mattress,) = geoms(crib(0.7), "crib_sheet"), geoms(crib(0.7), "crib_mattress")
    assert (sheet.type, sheet.contype, sheet.conaffinity) == ("plane", 1, 1)
    assert mattress.contype == mattress.conaffinity == 0


def test_an_infants_weight_sinks_in_by_some_millimetres():
    ball = '<body pos="0 0 0.061"><freejoint/><geom name="ball" size=".06" mass="3"/></body>'
    model = compiled(crib(0.7), ball)
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=1500)
    assert 0.002 < 0.06 - data.xpos[1, 2] < 0.02
    assert abs(data.qvel).max() < 1e-2


def test_a_ball_cannot_leave_between_the_bars():
    ball = '<body pos="0 0 0.1"><freejoint/><geom size=".035" mass=".1"/></body>'
    model = compiled(crib(0.7), ball)
    for angle in np.linspace(0, 2 * math.pi, 24, endpoint=False):
        data = mujoco.MjData(model)
        data.qvel[:2] = 2 * np.cos(angle), 2 * np.sin(angle)
        mujoco.mj_step(model, data, nstep=800)
        assert (np.abs(data.qpos[:2]) < (0.6, 0.3)).all()
