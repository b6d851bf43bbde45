import math

import mujoco
import numpy as np
import pytest

from mimoc.compiler.mjcf.world import FreeObject
from mimoc.compiler.toys.choosing import Toy, choose_toys
from mimoc.compiler.toys.objects import make_object
from mimoc.components.toys.builtin import BUILTIN_TOYS
from mimoc.schema.toys import ToysSpec

RED, BLUE, DARK, LIGHT = (1.0, 0.0, 0.0, 1.0), (0.0, 0.0, 1.0, 1.0), (0.1, 0.1, 0.1, 1.0), (0.9, 0.9, 0.9, 1.0)
COLOURS = {"main": RED, "accent": BLUE, "dark": DARK, "light": LIGHT}


@pytest.fixture(params=BUILTIN_TOYS.names)
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
