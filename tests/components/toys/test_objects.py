import colorsys
import math
from collections import Counter
from dataclasses import replace
from functools import cache

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from scipy import stats
from support.full import full_but

from mimoc.base.random_streams import stream
from mimoc.compiler.mjcf.world import FreeObject
from mimoc.compiler.toys import (
    BRIGHTNESS,
    GAP_M,
    SATURATION,
    Floor,
    ReachableFloor,
    Toy,
    Toybox,
    choose_toys,
    make_object,
    place_toys,
)
from mimoc.components.toys.builtin import BUILTIN_TOYS
from mimoc.schema.objects import ToysSpec

RED, BLUE, DARK, LIGHT = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0), (0.1, 0.1, 0.1, 1.0), (0.9, 0.9, 0.9, 1.0)
EXAMPLES = full_but(("ball", "cup", "truck"), BUILTIN_TOYS.names)
COLOURS = {"main": RED, "accent": BLUE, "dark": DARK, "light": LIGHT}


@pytest.fixture(params=EXAMPLES)
def toy(request) -> Toy:
    return Toy(BUILTIN_TOYS.load(request.param), 0.1, 0.5, COLOURS)


def test_a_prop_says_what_it_is_and_where(toy):
    prop = make_object(toy, 3, (0.4, -0.2))
    assert prop.name == f"toy3_{toy.model.name}"
    assert (prop.object, prop.category, prop.source) == (toy.model.name, toy.model.category, toy.model.source)
    assert (prop.pos_m, prop.size_m, prop.mass_kg) == ((0.4, -0.2, 0.0), 0.1, toy.mass_kg)
    assert prop.quat == pytest.approx((math.cos(0.25), 0, 0, math.sin(0.25)))


def test_the_mass_is_that_of_the_solids(toy):
    assert sum(geom.mass_kg for geom in make_object(toy, 1, (0, 0)).geoms) == pytest.approx(toy.mass_kg)


def test_what_is_seen_is_not_felt_and_what_is_felt_is_not_seen(toy):
    for geom in make_object(toy, 1, (0, 0)).geoms:
        seen, felt = "_looks_" in geom.name, "_solid" in geom.name
        assert (geom.contype, geom.conaffinity, geom.group) == (felt, felt, 1 if seen else 3)
        assert (geom.mass_kg == 0) == seen


def test_parts_wear_the_colours_of_the_toy(toy):
    prop = make_object(toy, 1, (0, 0))
    colours = {material.name: material.rgba for material in prop.materials}
    for part, geom in zip(toy.model.parts, prop.geoms, strict=False):
        assert colours[geom.material] == COLOURS[part.tint]


def test_the_looks_are_as_long_as_the_toy_and_stand_on_the_floor(toy):
    vertices = np.concatenate([corners(prop_mesh.content) for prop_mesh in make_object(toy, 1, (0, 0)).meshes])
    assert np.ptp(vertices, axis=0).max() == pytest.approx(0.1, rel=0.01)
    assert vertices[:, 2].min() == pytest.approx(0, abs=1e-3)
    assert np.linalg.norm(vertices[:, :2], axis=1).max() == pytest.approx(toy.radius_m, rel=0.15)


def test_the_solids_are_within_the_radius_that_is_kept_free(toy):
    model = compiled([make_object(toy, 1, (0, 0))])
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    for angle in np.linspace(0, 2 * math.pi, 24, endpoint=False):
        far = 2 * np.array([math.cos(angle), math.sin(angle), 0])
        gaps = [mujoco.mj_geomDistance(model, data, geom, post(model, data, far), 3.0, None) for geom in solids(model)]
        assert 2 - min(gaps) - 0.001 <= toy.radius_m + 1e-6


def test_a_toy_that_stands_on_a_cylinder_leans_by_more_than_rounding():
    """MuJoCo loses the contacts of a cylinder that is upright but for rounding."""
    model = compiled([make_object(Toy(BUILTIN_TOYS.load("bottle"), 0.1, 0.5, COLOURS), 1, (0, 0))])
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, nstep=1000)
    assert 1e-8 < np.hypot(*data.qpos[4:6]) < 1e-4


def test_names_are_unique_among_toys_of_one_kind():
    ball = Toy(BUILTIN_TOYS.load("ball"), 0.1, 0.0, COLOURS)
    props = [make_object(ball, number, (number, 0)) for number in (1, 2)]
    for things in ("geoms", "materials", "meshes"):
        names = [thing.name for prop in props for thing in getattr(prop, things)]
        assert len(set(names)) == len(names)
    assert len({prop.joint for prop in props}) == 2


def test_a_ball_that_rolls_slows_down_and_a_block_stops_soon():
    for name in ("ball", "apple", "sofa", "car"):
        model = compiled([make_object(Toy(BUILTIN_TOYS.load(name), 0.08, 0.0, COLOURS), 1, (0, 0))])
        data = mujoco.MjData(model)
        data.qvel[0] = 0.3
        mujoco.mj_step(model, data, nstep=3000)
        assert np.abs(data.qvel[:3]).max() < (0.02 if name in ("ball", "apple") else 1e-3), name
        assert data.qpos[0] < (3 if name in ("ball", "apple") else 0.1)


def test_a_thousand_toys_have_masses_like_toys():
    toys = [toy for seed in range(250) for toy in choose_toys(ToysSpec(count=(4, 4)), seed, BUILTIN_TOYS)]
    masses = [make_object(toy, 1, (0, 0)).mass_kg for toy in toys]
    assert 0.0005 < min(masses) < max(masses) < 1


def corners(obj: bytes) -> np.ndarray:
    """Return the vertices of an OBJ."""
    return np.array([line.split()[1:] for line in obj.decode().splitlines() if line.startswith("v ")], float)


def solids(model: mujoco.MjModel) -> list[int]:
    return [geom for geom in range(model.ngeom) if "_solid" in model.geom(geom).name]


def post(model: mujoco.MjModel, data: mujoco.MjData, place: np.ndarray) -> int:
    """Return a thin upright post that is moved to a place."""
    found = model.geom("post").id
    data.geom_xpos[found] = place
    return found


def compiled(props: list[FreeObject]) -> mujoco.MjModel:
    """Return props on a floor, without their looks."""

    def text(numbers) -> str:
        return " ".join(map(str, numbers))

    bodies = ""
    for prop in props:
        geoms = "".join(
            f'<geom name="{geom.name}" type="{geom.type}" size="{text(dict(geom.sizes)["size"])}" '
            f'pos="{text(geom.pos_m)}" quat="{text(geom.quat)}" mass="{geom.mass_kg}" condim="{geom.condim}" '
            f'friction="{text(geom.friction)}" solref="0.005 1"/>'
            for geom in prop.geoms
            if geom.sizes
        )
        place = f'pos="{text(prop.pos_m)}" quat="{text(prop.quat)}"'
        bodies += f'<body {place}><freejoint name="{prop.joint}"/>{geoms}</body>'
    floor = '<geom type="plane" size="9 9 1" solref="0.005 1"/>'
    far = '<geom name="post" type="cylinder" size="0.001 1" contype="0" conaffinity="0"/>'
    option = '<option timestep="0.005" cone="elliptic" integrator="implicitfast"/>'
    return mujoco.MjModel.from_xml_string(f"<mujoco>{option}<worldbody>{floor}{far}{bodies}</worldbody></mujoco>")


NOTHING = np.empty((0, 3))
ENDLESS = Floor((100.0, 100.0), NOTHING)
REACH = ReachableFloor((0.2, -0.1), 0.4, 0.1)


def share_within(reach: ReachableFloor, distance_m: np.ndarray) -> np.ndarray:
    """Return what share of all places `density` puts nearer than some distances, integrated by small steps."""
    grid = np.linspace(0, reach.radius_m + 40 * reach.fading_m, 200_001)
    rings = np.cumsum(reach.density(grid) * 2 * np.pi * grid)
    return np.interp(distance_m, grid, rings / rings[-1])


def distances(places: np.ndarray, reach: ReachableFloor) -> np.ndarray:
    return np.linalg.norm(places - reach.centre_m, axis=1)


def test_a_toy_is_as_likely_anywhere_within_reach_and_rarer_beyond():
    density = REACH.density(np.array([0.0, 0.39, 0.5, 0.6]))
    assert density == pytest.approx([1, 1, np.exp(-1), np.exp(-2)])


@pytest.mark.parametrize(
    "reach", [REACH, ReachableFloor((0, 0), 0.05, 0.3), ReachableFloor((1, 2), 0.6, 0.02)], ids=str
)
def test_places_are_as_far_as_the_stated_distribution_says(reach):
    drawn = reach.draw(20_000, stream(0, "places"))
    assert stats.kstest(distances(drawn, reach), lambda far: share_within(reach, far)).pvalue > 0.01


def test_the_first_toys_of_a_thousand_scenes_are_as_far_as_the_stated_distribution_says():
    """A histogram of ten bins that are all alike likely."""
    first = np.concatenate([place_toys([0.05], REACH, ENDLESS, stream(seed, "toys.place")) for seed in range(1000)])
    counts = np.histogram(share_within(REACH, distances(first, REACH)), 10, (0, 1))[0]
    assert stats.chisquare(counts).pvalue > 0.01


def test_toys_are_in_all_directions_alike():
    drawn = REACH.draw(10_000, stream(0, "places")) - REACH.centre_m
    counts = np.histogram(np.arctan2(*drawn.T), 12, (-np.pi, np.pi))[0]
    assert stats.chisquare(counts).pvalue > 0.01


def test_what_is_taken_changes_nothing_about_the_rest_of_the_floor():
    """Where a disc is taken, toys are drawn anew: on free floor, their distances are distributed as without it."""
    taken = Floor((100.0, 100.0), np.array([[0.2, -0.1, 0.25]]))
    first = np.concatenate([place_toys([0.05], REACH, taken, stream(seed, "toys.place")) for seed in range(1000)])
    nearest = 0.25 + 0.05 + GAP_M
    start = share_within(REACH, np.array(nearest))
    shares = (share_within(REACH, distances(first, REACH)) - start) / (1 - start)
    assert stats.kstest(shares, "uniform").pvalue > 0.01


@given(st.integers(0, 2**53), st.lists(st.floats(0.01, 0.1), min_size=1, max_size=12))
def test_toys_are_apart_from_each_other_from_what_is_there_and_inside(seed, radii):
    taken = np.array([[0.0, 0.0, 0.2], [0.3, 0.1, 0.05]])
    floor = Floor((1.2, 0.9), taken)
    places = place_toys(radii, REACH, floor, stream(seed, "toys.place"))
    discs = np.vstack([taken, np.column_stack([places, radii])])
    gaps = np.linalg.norm(discs[:, None, :2] - discs[:, :2], axis=2) - discs[:, 2] - discs[:, None, 2]
    assert gaps[np.triu_indices(len(discs), 1)][1:].min() >= GAP_M - 1e-12
    assert (np.abs(places) + np.array(radii)[:, None] + GAP_M <= np.array(floor.half_size_m) + 1e-12).all()


def test_the_first_toys_stay_where_they_are_when_there_are_more():
    few, many = (place_toys([0.05] * count, REACH, ENDLESS, stream(3, "toys.place")) for count in (3, 8))
    assert (few == many[:3]).all()


def test_where_there_is_no_room_there_are_no_places():
    assert place_toys([0.05], REACH, Floor((0.04, 1.0), NOTHING), stream(0, "toys.place")) is None
    assert place_toys([0.05] * 50, REACH, Floor((0.3, 0.3), NOTHING), stream(0, "toys.place")) is None


def test_no_toys_need_no_place():
    assert place_toys([], REACH, ENDLESS, stream(0, "toys.place")).shape == (0, 2)


USUAL = ToysSpec()
SIX = ToysSpec(count=(6, 6))


@cache
def chosen() -> list[tuple[Toy, ...]]:
    return [choose_toys(USUAL, seed, BUILTIN_TOYS) for seed in range(1000)]


def everything() -> list[Toy]:
    return [toy for toys in chosen() for toy in toys]


def evenly(values: list[float], low: float, high: float) -> bool:
    """Return whether values are inside a range and cover it evenly, by a chi-square test of ten bins."""
    assert low <= min(values) <= max(values) <= high
    return stats.chisquare(np.histogram(values, 10, (low, high))[0]).pvalue > 0.01


def hsv(toy: Toy, tint: str) -> tuple[float, float, float]:
    return colorsys.rgb_to_hsv(*toy.colours[tint][:3])


def test_each_count_of_the_range_is_alike_likely():
    counts = Counter(len(toys) for toys in chosen())
    assert set(counts) == {3, 4, 5, 6}
    assert stats.chisquare(list(counts.values())).pvalue > 0.01


def test_sizes_cover_their_range_evenly():
    assert evenly([toy.size_m for toy in everything()], 0.04, 0.12)


def test_turns_cover_the_circle_evenly():
    assert evenly([toy.yaw_rad for toy in everything()], 0, 2 * np.pi)


def test_every_toy_has_its_turn():
    counts = Counter(toy.model.name for toy in everything())
    assert set(counts) == set(BUILTIN_TOYS.names)
    assert stats.chisquare(list(counts.values())).pvalue > 0.01


def test_colours_have_any_hue_and_are_neither_pale_nor_dark():
    hues, saturations, brightnesses = zip(*(hsv(toy, "main") for toy in everything()), strict=True)
    assert evenly(hues, 0, 1)
    assert evenly(saturations, SATURATION[0] - 1e-3, SATURATION[1] + 1e-3)
    assert evenly(brightnesses, BRIGHTNESS[0] - 1e-3, BRIGHTNESS[1] + 1e-3)


def test_the_second_colour_is_about_opposite_the_first():
    for toy in everything():
        apart = abs(hsv(toy, "main")[0] - hsv(toy, "accent")[0])
        assert 0.41 < min(apart, 1 - apart) <= 0.5


def test_changing_one_aspect_changes_no_other():
    """More toys leave the first ones alone, and other sizes or another box leave colours and turns alone."""
    small = ToysSpec(count=(6, 6), size_cm=(2, 3))
    balls = Toybox(("ball",), BUILTIN_TOYS.load)
    for seed in range(50):
        six = choose_toys(SIX, seed, BUILTIN_TOYS)
        assert choose_toys(ToysSpec(count=(2, 2)), seed, BUILTIN_TOYS) == six[:2]
        for other in (choose_toys(small, seed, BUILTIN_TOYS), choose_toys(SIX, seed, balls)):
            assert [(toy.colours, toy.yaw_rad) for toy in other] == [(toy.colours, toy.yaw_rad) for toy in six]
        assert [toy.model for toy in choose_toys(small, seed, BUILTIN_TOYS)] == [toy.model for toy in six]
        assert [toy.size_m for toy in choose_toys(SIX, seed, balls)] == [toy.size_m for toy in six]


def test_another_seed_gives_other_toys():
    assert choose_toys(SIX, 1, BUILTIN_TOYS) != choose_toys(SIX, 2, BUILTIN_TOYS)


def test_there_may_be_none():
    assert choose_toys(ToysSpec(count=(0, 0)), 0, BUILTIN_TOYS) == ()


@pytest.mark.parametrize("name", EXAMPLES)
def test_a_toy_twice_as_large_weighs_eight_times_as_much(name):
    model = BUILTIN_TOYS.load(name)
    small, large = (Toy(model, size, 0.0, {}) for size in (0.05, 0.1))
    assert small.mass_kg == pytest.approx(model.volume * 0.05**3 * model.density_kg_m3)
    assert large.mass_kg == pytest.approx(8 * small.mass_kg)
    assert large.radius_m == pytest.approx(2 * small.radius_m)


def test_the_radius_of_a_ball_is_half_its_size():
    assert Toy(BUILTIN_TOYS.load("ball"), 0.1, 0.0, {}).radius_m == pytest.approx(0.05, rel=0.02)


def test_progress_counts_the_toys_that_are_loaded():
    told: list[tuple[int, int]] = []
    choose_toys(SIX, 1, replace(BUILTIN_TOYS, progress=lambda done, total: told.append((done, total))))
    assert told == [(done, 6) for done in range(6)]
