"""What objects are made of, and how they move."""

import math

import mujoco
import numpy as np
import pytest
import trimesh
from support.scenes_of_objects import built_with, fastest_m_s, spec_with, started

import mimoc
from mimoc.base.errors import SpecError
from mimoc.compiler.objects.built_object import DAMPING_RATIO
from mimoc.components.objects.shape import DENSITIES_KG_M3

AT = {"at": {"x_cm": 60, "y_cm": 0}}


def geom_of(bundle, name):
    model, data = started(bundle)
    return model, data, model.geom(f"object_{name}")


@pytest.mark.parametrize(
    ("shape", "volume_m3"),
    [
        ({"shape": "sphere", "radius_cm": 4}, 4 / 3 * math.pi * 0.04**3),
        ({"shape": "box", "sides_cm": [4, 6, 8]}, 0.04 * 0.06 * 0.08),
        ({"shape": "cylinder", "radius_cm": 2, "length_cm": 10}, math.pi * 0.02**2 * 0.1),
        ({"shape": "capsule", "radius_cm": 2, "length_cm": 10}, math.pi * 0.02**2 * 0.06 + 4 / 3 * math.pi * 0.02**3),
        ({"shape": "ellipsoid", "sides_cm": [4, 6, 8]}, 4 / 3 * math.pi * 0.02 * 0.03 * 0.04),
    ],
)
def test_a_shape_weighs_its_volume_times_its_density(shape, volume_m3):
    bundle = built_with({"name": "thing", **shape, "material": "wood", **AT})
    model, _ = started(bundle)
    mass_kg = volume_m3 * DENSITIES_KG_M3["wood"]
    assert model.body("object_thing").mass[0] == pytest.approx(mass_kg, rel=1e-6)
    assert bundle.manifest.objects[0].mass_kg == pytest.approx(mass_kg, rel=1e-6)
    assert bundle.manifest.objects[0].material == "wood"


def test_the_mass_or_the_density_of_a_spec_counts():
    ball = {"name": "ball", "radius_cm": 4, **AT}
    assert started(built_with({**ball, "mass_g": 60}))[0].body("object_ball").mass[0] == pytest.approx(0.06)
    dense = started(built_with({**ball, "density_kg_m3": 100}))[0].body("object_ball").mass[0]
    assert dense == pytest.approx(100 * 4 / 3 * math.pi * 0.04**3, rel=1e-6)


def test_friction_and_colour_are_those_of_the_spec():
    model, _, geom = geom_of(built_with({"name": "ball", "friction": 0.3, "colour": [0, 0.5, 1], **AT}), "ball")
    assert geom.friction[0] == pytest.approx(0.3)
    np.testing.assert_allclose(model.material("object_ball").rgba, (0, 0.5, 1, 1))


def test_a_toy_has_its_size_and_its_usual_material():
    bundle = built_with({"name": "bear", "toy": "bunny", "size_cm": 10, **AT})
    (entry,) = bundle.manifest.objects
    assert entry.material == "cloth"
    assert entry.size_m == pytest.approx(0.1, rel=0.2)
    assert len(entry.geoms) == 6


@pytest.mark.full
def test_a_mesh_of_ones_own_is_cleaned_and_stands_on_the_floor(tmp_path, monkeypatch):
    monkeypatch.setenv("MIMOC_CACHE", str(tmp_path / "cache"))
    for kind in ("stl", "obj", "glb"):
        trimesh.creation.box(extents=(1, 2, 3)).export(tmp_path / f"brick.{kind}")
        path = tmp_path / "spec.yaml"
        path.write_text(
            "mimoc: 1\nname: x\nage_months: 6\nbody: {skin: false}\nscene:\n  objects:\n"
            f"    - {{name: brick, mesh: brick.{kind}, size_cm: 6, mass_g: 50, at: {{x_cm: 60, y_cm: 0}}}}\n"
        )
        bundle = mimoc.build(path)
        model, data = started(bundle)
        assert model.body("object_brick").mass[0] == pytest.approx(0.05, rel=1e-6)
        for _ in range(400):
            mujoco.mj_step(model, data)
        assert fastest_m_s(bundle, model, data) < 1e-3
        assert bundle.manifest.objects[0].size_m == pytest.approx(0.06, rel=1e-3)


def test_a_toy_of_a_folder_is_named_by_its_file(tmp_path, monkeypatch):
    monkeypatch.setenv("MIMOC_CACHE", str(tmp_path / "cache"))
    trimesh.creation.icosphere().export(tmp_path / "globe.stl")
    spec = spec_with({"name": "globe", "toy": "globe", "root": str(tmp_path), **AT})
    assert mimoc.build(mimoc.InfantSpec.model_validate(spec)).manifest.objects[0].name == "globe"


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ({"toy": "bnny"}, "scene.objects[0].toy: 'bnny' is not one of mimoc's toys; did you mean 'bunny'"),
        ({"mesh": "no.stl"}, "scene.objects[0].mesh: 'no.stl' cannot be read"),
        ({"mesh": "no.png"}, "scene.objects[0].mesh: 'no.png' is no mesh that can be read"),
        ({"toy": "x", "root": "nowhere"}, "scene.objects[0].root:"),
    ],
)
def test_what_is_missing_is_refused_at_its_key(keys, message):
    with pytest.raises(SpecError) as refusal:
        mimoc.build(mimoc.InfantSpec.model_validate(spec_with({"name": "thing", **keys, **AT})))
    assert message in str(refusal.value)
    assert len(refusal.value.problems) == 1


def test_a_hanging_object_swings_as_a_pendulum_and_comes_to_rest():
    """Period 2 pi sqrt(I / m g l) and the damping ratio of its string, of a small ball on a long tether."""
    bundle = built_with({"name": "bob", "radius_cm": 1, "above": "head", "height_cm": 60, "tether_cm": 40})
    model, data = started(bundle)
    assert bundle.manifest.objects[0].motion == "hanging"
    assert fastest_m_s(bundle, model, data) == 0.0
    tilt = 0.05
    address = model.joint("object_bob_tether").qposadr[0]
    data.qpos[address : address + 4] = (math.cos(tilt / 2), math.sin(tilt / 2), 0.0, 0.0)
    body, angles = model.body("object_bob").id, []
    for _ in range(round(4.0 / model.opt.timestep)):
        mujoco.mj_step(model, data)
        angles.append(math.atan2(data.xmat[body].reshape(3, 3)[1, 2], data.xmat[body].reshape(3, 3)[2, 2]))
    crossings = np.flatnonzero(np.diff(np.sign(angles)) > 0) * model.opt.timestep
    length_m = 0.41
    inertia = length_m**2 + 0.4 * 0.01**2
    assert np.diff(crossings).mean() == pytest.approx(2 * math.pi * math.sqrt(inertia / (9.81 * length_m)), rel=0.02)
    peaks = [max(np.abs(angles[start : start + 254])) for start in (0, 254)]
    assert math.log(peaks[0] / peaks[1]) == pytest.approx(2 * math.pi * DAMPING_RATIO, rel=0.2)


def test_a_sliding_object_stays_on_its_axis_and_stops_by_friction():
    car = {"name": "car", "shape": "box", "motion": "sliding", "friction": 0.5, "slide_cm": [-5, 20]}
    bundle = built_with({**car, "at": {"x_cm": 60, "y_cm": 0}, "yaw_deg": 90})
    model, data = started(bundle)
    start_m = data.body("object_car").xpos.copy()
    data.joint("object_car_slide").qvel[0] = 0.5
    for _ in range(400):
        mujoco.mj_step(model, data)
    moved_m = data.body("object_car").xpos - start_m
    assert moved_m[1] == pytest.approx(0.5**2 / (2 * 0.5 * 9.81), rel=0.1)
    assert abs(moved_m[0]) < 1e-6
    assert abs(moved_m[2]) < 1e-6
    assert fastest_m_s(bundle, model, data) < 1e-3


def test_a_fixed_object_does_not_move_when_it_is_struck():
    bundle = built_with(
        {"name": "post", "shape": "capsule", "motion": "fixed", "at": {"x_cm": 60, "y_cm": 0}},
        {"name": "ball", "radius_cm": 2, "mass_g": 500, "at": {"x_cm": 70, "y_cm": 0}},
    )
    model, data = started(bundle)
    data.joint("object_ball_free").qvel[0] = -2.0
    before_m = data.body("object_post").xpos.copy()
    for _ in range(200):
        mujoco.mj_step(model, data)
    np.testing.assert_array_equal(data.body("object_post").xpos, before_m)
    assert data.body("object_ball").xpos[0] > 0.6
