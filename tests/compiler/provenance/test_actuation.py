"""What drives an infant, and its task, say where their numbers come from, and they are those in the model."""

import re
from graphlib import TopologicalSorter

import numpy as np
import pytest
from lxml import etree
from support import store

import mimoc
from mimoc.compiler.explain import entries_of, explain
from mimoc.schema.kinds import ACTUATIONS, TASKS

STRENGTH = {"strength": {"arms": 2, "left_arm": 3}, "strength_age_months": 18}
PLACE = re.compile(r"(.+): (\w+)\[@name='(.+)'\]/@(\w+)")


@pytest.fixture(scope="module", params=ACTUATIONS)
def bundle(request):
    spec = {
        "mimoc": 1,
        "name": "x",
        "age_months": 9,
        "development": "published",
        "actuation": {"model": request.param, **STRENGTH},
        "body": {"remove": ["right_hand"]},
    }
    return store.built(spec)


@pytest.fixture
def entries(bundle):
    return entries_of(bundle)


def written(bundle, tag):
    """Return the attributes of each element of a kind, by its name."""
    elements = etree.fromstring(bundle.files["infant.xml"]).iter(tag)
    return {element.get("name"): dict(element.attrib) for element in elements if element.get("name")}


def numbers(text):
    return [float(word) for word in text.split()]


@pytest.mark.parametrize("tag", ["general", "joint"])
def test_every_number_is_the_one_in_the_xml(bundle, entries, tag):
    elements, found = written(bundle, tag), 0
    for key, entry in entries.items():
        place = PLACE.fullmatch(entry.get("xml", ""))
        if place and place[2] == tag:
            value = entry["value"] if isinstance(entry["value"], list) else [entry["value"]]
            assert numbers(elements[place[3]][place[4]]) == pytest.approx(value, rel=1e-8), key
            found += 1
    assert found >= len(elements)


def test_every_strength_of_an_actuator_has_an_entry(bundle, entries):
    """All its numbers but those that say how it is commanded: its control range, and the sign of a muscle."""
    model = bundle.manifest.actuation.model
    told = {"name", "class", "joint", "ctrlrange"} | (set() if model == "torque" else {"gear"})
    for name, attributes in written(bundle, "general").items():
        for attribute in attributes.keys() - told:
            assert f"actuator.{name}.{attribute}" in entries


def test_sources_exist_and_never_lead_in_a_circle(entries):
    graph = {key: entry.get("from", ()) for key, entry in entries.items()}
    assert {source for sources in graph.values() for source in sources} <= graph.keys()
    assert len(list(TopologicalSorter(graph).static_order())) == len(entries)


def test_a_gear_names_what_made_it_stronger(bundle, entries):
    keys = {"left": "spec.actuation.strength.left_arm", "right": "spec.actuation.strength.arms"}
    for side, factor in (("left", 3), ("right", 2)):
        gear = entries[f"actuator.act:{side}_elbow.gear"]
        assert gear["from"][-2:] == [keys[side], "spec.actuation.strength_age_months"]
        assert f"x {factor} ({keys[side]})" in gear["rule"]


def test_a_servo_leads_back_to_the_gear(bundle, entries):
    if bundle.manifest.actuation.model == "position":
        limits = entries["actuator.act:left_elbow.forcerange"]
        gear_nm = entries["actuator.act:left_elbow.gear"]["value"]
        assert limits["value"] == pytest.approx([-gear_nm, 0.83 * gear_nm])
        assert limits["from"] == ["actuator.act:left_elbow.gear"]
        assert "actuator.act:left_elbow.gear" in entries["joint.robot:left_elbow.damping"]["from"]


def test_a_joint_says_why_it_is_harder_to_swing(bundle, entries):
    """Its arm is made two or three times as strong as that of 18 months."""
    for side in ("left", "right"):
        armature, gear_nm = (
            entries[f"joint.robot:{side}_elbow.armature"],
            entries[f"actuator.act:{side}_elbow.gear"]["value"],
        )
        assert armature["value"] == pytest.approx(gear_nm / 3.6 * 0.002)
        assert f"x {gear_nm / 3.6:.6g}, by which its motor is stronger" in armature["rule"]
        assert armature["from"] == ["spec.development", f"actuator.act:{side}_elbow.gear"]


def test_a_muscle_leads_back_to_mimos_and_what_made_it_stronger(bundle, entries):
    """Of the published law, by which it does not grow."""
    if bundle.manifest.actuation.model == "muscle":
        flexor, range_rad = entries["actuator.act:left_elbow_negative.gainprm"], np.radians(146 + 5)
        assert flexor["value"][2] == pytest.approx(3 * 35.43 * 0.3 / range_rad)
        assert flexor["from"] == ["spec.development", "spec.actuation.strength.left_arm"]


def test_a_muscle_that_matures_leads_back_to_the_gear():
    entries = entries_of(store.built({"mimoc": 1, "name": "x", "age_months": 9, "actuation": {"model": "muscle"}}))
    flexor = entries["actuator.act:left_elbow_negative.gainprm"]
    assert flexor["value"][2] == pytest.approx(1.02 * entries["actuator.act:left_elbow.gear"]["value"])
    assert "actuator.act:left_elbow.gear" in flexor["from"]


KINDS = [kind for kind in TASKS if kind != "free"]


@pytest.mark.parametrize("kind", KINDS)
def test_every_number_of_a_task_can_be_explained(kind):
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "task": {"kind": kind}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(spec))
    numbers = {name: value for name, value in bundle.manifest.task.model_dump().items() if isinstance(value, float)}
    for name, value in numbers.items():
        explained = explain(bundle, f"task.{kind}.{name}")
        assert str(explained)
        assert entries_of(bundle)[f"task.{kind}.{name}"]["value"] == value
