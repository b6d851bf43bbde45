"""Every number of a world, and every number that `build` prints, can be explained and is the one that was built."""

import numpy as np
import pytest
from lxml import etree
from support import store

import mimoc
from mimoc.compiler.explain import contents, entries_of, explain, find
from mimoc.compiler.provenance import who_percentiles

SCENES = {
    "room": {"kind": "room", "seed": 7, "pose": "sitting", "toys": {"count": [3, 3]}},
    "crib": {"kind": "crib", "toys": {"count": [2, 2]}},
    "flat": {"kind": "flat"},
}


@pytest.fixture(scope="module", params=SCENES)
def bundle(request) -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "scene": SCENES[request.param], "task": {"kind": "reach"}}
    return store.built(spec)


@pytest.fixture(scope="module")
def entries(bundle) -> dict:
    return entries_of(bundle)


def test_all_that_build_prints_can_be_asked_for(bundle, entries):
    child = bundle.manifest.child.model_dump()
    for name, percentile in who_percentiles(bundle.manifest.child).items():
        assert entries[f"child.{name}"]["value"] == child[name]
        assert entries[f"who.{name}.percentile"]["value"] == pytest.approx(percentile)
    for toy in bundle.manifest.toys:
        told = {name: entries[f"toy.{toy.body}.{name}"]["value"] for name in ("object", "size", "mass")}
        assert told == {"object": toy.object, "size": toy.size_m, "mass": toy.mass_kg}


def test_every_key_leads_back_to_keys_that_are_there(bundle, entries):
    for key in entries:
        assert explain(bundle, key).lines


def test_what_is_written_to_the_scene_is_what_stands_there(bundle, entries):
    """Apart from masses, which several geoms share."""
    scene = etree.fromstring(bundle.files["scene.xml"])
    traced = {key: entry for key, entry in entries.items() if entry.get("xml", "").startswith("scene.xml: ")}
    assert traced
    for entry in traced.values():
        path, _, attribute = entry["xml"].removeprefix("scene.xml: ").rpartition("/@")
        elements = scene.xpath(f"//{path}")
        written = [float(number) for element in elements for number in element.get(attribute).split()]
        value = np.atleast_1d(entry["value"])
        found = [sum(written)] if attribute == "mass" else written[: len(value)]
        assert found == pytest.approx(value, rel=1e-6)


def test_what_chance_decides_names_its_stream_and_the_seed(entries):
    drawn = {key: entry for key, entry in entries.items() if entry["rule"].startswith("drawn ")}
    assert all("spec.scene.seed" in entry["from"] and "by the stream '" in entry["rule"] for entry in drawn.values())
    toys = [key for key in entries if key.startswith("toy.") and key.endswith((".size", ".pos", ".yaw", ".object"))]
    assert set(toys) <= drawn.keys()


def test_a_room_tells_its_size_and_where_the_infant_is():
    bundle = mimoc.build(mimoc.InfantSpec(mimoc=1, name="x", age_months=9, scene=SCENES["room"]))
    entries = entries_of(bundle)
    scene = etree.fromstring(bundle.files["scene.xml"])
    half = [float(number) for number in scene.xpath("//geom[@name='floor']/@size")[0].split()]
    assert entries["room.size"]["value"][:2] == pytest.approx([2 * half[0], 2 * half[1]])
    qpos = [float(number) for number in scene.xpath("//key[@name='sitting']/@qpos")[0].split()]
    x_m, y_m = entries["room.infant.pos"]["value"]
    assert np.hypot(qpos[0] - x_m, qpos[1] - y_m) < 0.3
    assert 0 <= entries["room.infant.yaw"]["value"] < 2 * np.pi


@pytest.mark.parametrize("part", ["weight", "left_foot", "robot:left_elbow", "Head Circumference", "*.mass"])
def test_a_part_of_a_name_finds_all_that_have_it(part):
    spec = mimoc.InfantSpec(mimoc=1, name="x", age_months=9, scene=SCENES["room"])
    bundle = mimoc.build(spec)
    found = find(bundle, part)
    assert found
    wanted = part.lower().replace(" ", "_").strip("*")
    assert all(wanted in key for key in found)
    keys = [f"{thing}.{name}" for thing, names in contents(bundle).items() for name in names]
    assert set(found) <= set(keys)
