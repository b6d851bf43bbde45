"""Several infants compiled to one world: its names, its places, its bytes, and what is refused."""

import re

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings, strategies as st
from support.worlds import ANNA, BEN, plan, world, written

import mimoc
from mimoc.base.errors import BundleError, SpecError
from mimoc.bundle.model import check_fits
from mimoc.bundle.provenance import PROVENANCE, read_entries
from mimoc.bundle.world import START, load_world_model, overlaps
from mimoc.compiler.explain import explain
from mimoc.schema.infant import InfantSpec

PAIR = "infants: [anna.yaml, ben.yaml]\n"
PLAIN = InfantSpec(mimoc=1, name="plain", age_months=9)
STANDING = {"mimoc": 1, "name": "anna", "age_months": 12, "task": {"kind": "standup"}}


def started(bundle, key: str = START) -> tuple[mujoco.MjModel, mujoco.MjData]:
    model = load_world_model(bundle)
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(key).id)
    mujoco.mj_forward(model, data)
    return model, data


def roots(bundle) -> list[str]:
    return [infant.manifest.root_body for infant in bundle.infants.values()]


@pytest.fixture(scope="module")
def pair():
    return world(anna=ANNA, ben=BEN)


@pytest.mark.matrix
def test_the_same_specs_give_the_same_bytes(tmp_path, monkeypatch, pair):
    path = written(tmp_path, PAIR, anna=ANNA, ben=BEN)
    first = mimoc.build_world(path)
    monkeypatch.chdir(tmp_path)
    assert dict(mimoc.build_world("world.yaml").files) == dict(first.files)
    assert first.files["scene.xml"].replace(b'"pair scene"', b'"world scene"') == pair.files["scene.xml"]


def test_plain_mujoco_opens_a_world_and_nothing_moves_apart(tmp_path, pair):
    folder = mimoc.write_bundle(pair, tmp_path / "two")
    model = mujoco.MjModel.from_xml_path(str(folder / "scene.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("start").id)
    mujoco.mj_step(model, data, 100)
    assert not data.warning.number.any()
    assert abs(data.body("anna_hip").xpos[2]) < 0.3


def test_a_bundle_is_read_as_it_was_written_unless_it_was_changed(tmp_path, pair):
    folder = mimoc.write_bundle(pair, tmp_path / "two")
    read = mimoc.read_world_bundle(folder)
    assert dict(read.files) == dict(pair.files)
    assert read.infants["ben"].manifest == pair.infants["ben"].manifest
    assert read.infants["ben"].arrays.keys() == pair.infants["ben"].arrays.keys() > {"touch/points_m"}
    (folder / "infants" / "ben" / "manifest.json").write_text("{}")
    with pytest.raises(BundleError, match=r"infants/ben/manifest.json was changed"):
        mimoc.read_world_bundle(folder)
    with pytest.raises(BundleError, match="a bundle already exists here"):
        mimoc.write_bundle(pair, folder)


def test_a_world_is_refused_where_one_infant_is_wanted(tmp_path, pair):
    folder = mimoc.write_bundle(pair, tmp_path / "two")
    for read in (mimoc.read_bundle, mimoc.make):
        with pytest.raises(BundleError, match="this is a world with several infants, and one is wanted here"):
            read(folder)


def test_all_that_a_manifest_names_is_in_the_model_with_the_prefix_of_its_infant(tmp_path, pair):
    model = load_world_model(pair)
    for name, bundle in pair.infants.items():
        check_fits(tmp_path, bundle.manifest, bundle.manifest.timestep_ms, model)
        entries = [*bundle.manifest.actuation.actuators]
        assert all(entry.name.startswith(f"{name}_act:") and entry.joint.startswith(f"{name}_") for entry in entries)
        assert bundle.manifest.of_infant(bundle.manifest.root_body) == "hip"


def test_each_infant_has_the_body_that_it_has_alone(pair):
    model = load_world_model(pair)
    for name, data in {"anna": ANNA, "ben": BEN}.items():
        alone = mujoco.MjModel.from_xml_string(*_mjcf(mimoc.build(InfantSpec.model_validate(data))))
        for body in range(1, alone.nbody):
            mass, there = alone.body(body).mass, model.body(f"{name}_{alone.body(body).name}").mass
            assert mass == there
        for number in range(alone.nu):
            actuator = alone.actuator(number)
            assert np.array_equal(actuator.gear, model.actuator(f"{name}_{actuator.name}").gear)


def _mjcf(bundle):
    from mimoc.bundle.model import mjcf_of

    return mjcf_of(bundle.files, "scene.xml")


def test_every_number_of_a_world_knows_where_it_comes_from(pair):
    entries = read_entries(pair.files[PROVENANCE])
    scene = pair.files["scene.xml"].decode()
    for name in re.findall(r"\[@name='([^']+)'\]", "\n".join(entry.get("xml", "") for entry in entries.values())):
        assert f'name="{name}"' in scene
    assert entries["anna.body.head.mass"]["xml"] == "scene.xml: body[@name='anna_head']/geom/@mass"
    assert entries["place.ben.y_m"]["rule"].startswith("side by side along y, 10 cm apart")


OBJECTS = [
    {"kind": kind, "name": f"a_{kind}", "at": {"x_cm": 120 * number - 360, "y_cm": 150}}
    for number, kind in enumerate(("mat", "rail", "seat", "stairs", "slope", "screen", "table"))
]


@pytest.mark.parametrize(
    "scene",
    [
        {"kind": "room", "toys": {"count": [2, 2]}},
        {"kind": "crib", "toys": {"source": "builtin", "count": [1, 1]}},
        {"kind": "room", "objects": [{"name": "ball", "at": "within reach of right_hand"}]},
        {"kind": "flat", "objects": OBJECTS},
    ],
    ids=["toys in a room", "a toy in a crib", "a ball within reach", "objects of all kinds"],
)
def test_what_is_around_infants_can_be_explained(scene):
    """Sources that no number has would make the provenance unreadable."""
    bundle = mimoc.build_world({"anna": PLAIN, "ben": PLAIN.with_(age_months=6)}, scene=scene)
    entries = read_entries(bundle.files[PROVENANCE])
    around = [key for key in entries if key.startswith(("room.", "crib.", "toy.", "object."))]
    assert around
    assert all(explain(bundle, key).lines for key in around)


@pytest.mark.full
@pytest.mark.slow
@settings(max_examples=8, deadline=None)
@given(
    ages=st.lists(st.integers(0, 24), min_size=2, max_size=3),
    poses=st.lists(st.sampled_from(["supine", "prone", "sitting", "standing"]), min_size=3, max_size=3),
)
def test_infants_side_by_side_touch_in_none_of_their_poses(ages, poses):
    specs = {
        f"i{number}": InfantSpec.model_validate(
            {"mimoc": 1, "name": "one", "age_months": age, "senses": {}, "scene": {"pose": poses[number]}}
        )
        for number, age in enumerate(ages)
    }
    bundle = mimoc.build_world(specs)
    model, _ = started(bundle)
    of_infants = model.body_rootid[model.geom_bodyid]
    ids = [model.body(root).id for root in roots(bundle)]
    for key in range(model.nkey):
        _, data = started(bundle, model.key(key).name)
        pairs = of_infants[data.contact.geom]
        assert not ((pairs[:, 0] != pairs[:, 1]) & np.isin(pairs, ids).all(axis=1)).any()


def test_infants_within_each_other_are_refused_in_the_line_of_the_second(tmp_path):
    text = "infants:\n- {spec: anna.yaml, y_cm: 0}\n- {spec: ben.yaml, y_cm: 5}\n"
    with pytest.raises(SpecError, match=r"world.yaml:5:3: infants\[1\]: 'ben' starts .* cm within 'anna'; give one"):
        mimoc.build_world(written(tmp_path, text, anna=ANNA, ben=BEN))


def test_more_infants_than_there_can_be_are_one_line(tmp_path):
    path = written(tmp_path, f"infants: [{', '.join(['anna.yaml'] * 9)}]\n", anna=ANNA)
    with pytest.raises(SpecError, match=r"world.yaml:3:10: infants: expected at most 8 values, got 9$"):
        mimoc.build_world(path)


def test_infants_that_need_another_integrator_are_refused(tmp_path):
    path = written(tmp_path, PAIR, anna=ANNA, ben={**BEN, "actuation": {"model": "position"}})
    with pytest.raises(SpecError, match=r"world.yaml:3:22: infants\[1\]: 'ben' has 'position' actuators and 'anna' 't"):
        mimoc.build_world(path)


def test_a_world_is_built_again_from_what_it_says_of_itself(tmp_path):
    text = "infants: [anna.yaml, {spec: ben.yaml, yaw_deg: 30}]\nscene: {kind: flat, seed: 4}\n"
    bundle = mimoc.build_world(written(tmp_path, text, anna=ANNA, ben=BEN))
    folder = mimoc.write_bundle(bundle, tmp_path / "out")
    again = mimoc.build_world(folder / "resolved.yaml")
    assert again.files["scene.xml"] == bundle.files["scene.xml"]
    assert plan(folder / "resolved.yaml").spec.placed[1].yaw_deg == 30.0


def test_infants_have_tasks_of_their_own_at_their_places(tmp_path):
    text = "infants:\n- {spec: anna.yaml, x_cm: 50, yaw_deg: 90}\n- {spec: ben.yaml, y_cm: -80}\n"
    bundle = mimoc.build_world(written(tmp_path, text, anna=STANDING, ben=BEN))
    _, data = started(bundle)
    hands, rail = data.body("anna_left_hand").xpos - data.body("anna_right_hand").xpos, data.geom("anna_rail")
    along = rail.xmat.reshape(3, 3)[:, 2]
    assert abs(along @ hands) / np.linalg.norm(hands) > 0.99  # Both hands are at the rail, which turned with it.
    assert np.abs(data.efc_pos[data.efc_type == mujoco.mjtConstraint.mjCNSTR_EQUALITY]).max() < 1e-6
    assert bundle.infants["anna"].manifest.task.kind == "standup"


def test_a_world_has_toys_and_objects_that_all_infants_know():
    ball = {"kind": "shape", "name": "ball", "shape": "sphere", "radius_cm": 4, "mass_g": 60}
    scene = {"kind": "flat", "toys": {"count": [2, 2]}, "objects": [{**ball, "at": {"x_cm": 80, "y_cm": 0}}]}
    bundle = world(scene, anna=ANNA, ben=BEN)
    model, data = started(bundle)
    mujoco.mj_step(model, data, 50)
    for infant in bundle.infants.values():
        assert len(infant.manifest.toys) == 2
        assert [thing.name for thing in infant.manifest.objects] == ["ball"]
        for name in (*(toy.body for toy in infant.manifest.toys), infant.manifest.objects[0].body):
            assert model.body(name).id > 0


@pytest.mark.parametrize("kind", ["crib", "room", "empty"])
def test_infants_share_other_scenes(kind):
    bundle = world({"kind": kind}, anna=ANNA, ben=BEN)
    model, data = started(bundle)
    assert not overlaps(model, data, roots(bundle))
    walls = [name for name in range(model.ngeom) if model.geom_bodyid[name] == 0]
    deep = [contact.dist for contact in data.contact if contact.geom1 in walls and contact.dist < -0.01]
    assert not deep
    mujoco.mj_step(model, data, 50)
    assert not data.warning.number.any()


def test_what_of_an_infants_own_scene_has_no_effect_is_noted(tmp_path):
    path = written(tmp_path, PAIR, anna={**ANNA, "scene": {"kind": "crib", "pose": "prone"}}, ben=BEN)
    (note,) = mimoc.build_world(path).manifest.notes
    assert note == "'scene.kind' of 'anna' has no effect: it is in the scene of this world"
