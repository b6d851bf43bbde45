"""Every number of a body says where it comes from, and says the number that is in the model."""

import re
from graphlib import TopologicalSorter

import numpy as np
import pytest
from lxml import etree

import mimoc
from mimoc.compiler.explain import entries_of, explain
from mimoc.fits.tables import data_files
from mimoc.schema import read_spec
from mimoc.schema.source import parse

BODIES = ((0, "mitten", False), (5.25, "five_finger", True), (18, "mitten", True), (24, "five_finger", False))
JOINT_CONSTANTS = ("range", "stiffness", "damping", "frictionloss", "armature", "springref")
TABLE_ROW = re.compile(r"anthrokids\.csv:(\d+)")


@pytest.fixture(params=BODIES, ids=str)
def which(request) -> tuple[float, str, bool]:
    return request.param


@pytest.fixture
def bundle(which, bundle_at):
    return bundle_at(*which)


@pytest.fixture
def infant(which, infant_at):
    return infant_at(*which)


@pytest.fixture
def entries(bundle) -> dict[str, dict]:
    return entries_of(bundle)


def written(bundle, pointer: str) -> list[float]:
    """Return the numbers of the attributes that a pointer such as `infant.xml: geom[@name='head']/@size` leads to."""
    file, path = pointer.split(": ", 1)
    attributes = etree.fromstring(bundle.files[file]).xpath(f"//{path}")
    return [[float(word) for word in text.split()] for text in attributes]


@pytest.mark.full
def test_every_number_is_the_one_in_the_xml(bundle, entries):
    """A part's mass is the sum of its geoms', all others stand there as they are."""
    pointers = {key: entry["xml"] for key, entry in entries.items() if "xml" in entry}
    assert len(pointers) > 500
    for key, pointer in pointers.items():
        found, value = written(bundle, pointer), entries[key]["value"]
        assert found, key
        assert np.sum(found, axis=0) == pytest.approx(value, rel=1e-8), key
        assert len(found) == 1 or key.endswith(".mass"), key


def test_every_number_that_counts_has_an_entry(entries, infant):
    model = infant.model
    for index in range(1, model.nbody):
        body = model.body(index)
        assert entries[f"body.{body.name}.mass"]["value"] == pytest.approx(body.mass[0], rel=1e-8)
    for index in range(1, model.njnt):
        joint = model.joint(index)
        assert entries.keys() >= {f"joint.{joint.name}.{constant}" for constant in JOINT_CONSTANTS}
        assert entries[f"joint.{joint.name}.range"]["value"] == pytest.approx(joint.range)
        assert entries[f"joint.{joint.name}.armature"]["value"] == joint.armature[0]
        margin = entries.get(f"joint.{joint.name}.margin", {"value": 0})["value"]
        assert margin == pytest.approx(joint.margin[0])
    for index in range(model.nu):
        actuator = model.actuator(index)
        assert entries[f"actuator.{actuator.name}.gear"]["value"] == pytest.approx(actuator.gear[0])
        assert entries[f"actuator.{actuator.name}.forcerange"]["value"] == pytest.approx(actuator.forcerange)


def test_every_geom_of_the_body_has_its_size_place_and_mass(entries, infant):
    for name in infant.geoms(*(infant.model.body(index).name for index in range(1, infant.model.nbody))):
        size = entries[f"geom.{name}.size"]["value"]
        assert infant.model.geom(name).size[: len(size)] == pytest.approx(size, rel=1e-8), name
        assert infant.model.geom(name).pos == pytest.approx(entries[f"geom.{name}.pos"]["value"], abs=1e-9), name
        assert f"geom.{name}.mass" in entries


def test_sources_exist_and_never_lead_in_a_circle(entries):
    graph = {key: entry.get("from", ()) for key, entry in entries.items()}
    assert {source for sources in graph.values() for source in sources} <= graph.keys()
    assert len(list(TopologicalSorter(graph).static_order())) == len(entries)


def test_every_entry_ends_in_the_spec_or_in_the_reference_body_or_says_how_certain_it_is(entries):
    for key, entry in entries.items():
        assert entry["rule"], key
        if not entry.get("from"):
            assert key.startswith("spec.") or re.search(r"MIMo's reference body|[(;] ?[SMD]\)$", entry["rule"]), key
        if key.startswith("measurements."):
            assert entry["from"] == ["spec.age_months"]


def test_points_name_the_rows_of_the_table_they_stand_in(entries):
    rows = data_files()["anthrokids.csv"].decode().splitlines()
    fitted = [key for key, entry in entries.items() if entry.get("points")]
    assert len(fitted) > 20
    for key in fitted:
        name = key.removeprefix("measurements.").removesuffix("_cm")
        for point in entries[key]["points"]:
            for line in TABLE_ROW.findall(point["origin"]):
                assert rows[int(line) - 1].startswith(f"{name},"), point


def test_a_measurement_is_its_fit_at_its_age(bundle, entries):
    age_months = bundle.manifest.child.age_months
    for key, entry in entries.items():
        if "fit" in entry:
            fit = entry["fit"]
            found_cm = fit["a"] * np.log(age_months + fit["b"]) + fit["c"] + fit.get("d", 0) * age_months
            assert entry["value"] == pytest.approx(found_cm, rel=1e-7), key


def test_rules_of_the_published_law_are_the_same_at_every_age():
    keys = {"mimoc": 1, "name": "infant", "development": "published"}
    specs = [mimoc.InfantSpec.model_validate({**keys, "age_months": age_months}) for age_months in (0, 24)]
    young, old = (entries_of(mimoc.build(spec)) for spec in specs)
    young["who.arm_circumference_cm.percentile"] = old["who.arm_circumference_cm.percentile"]  # WHO's start at 91 days.
    assert {key: entry["rule"] for key, entry in young.items()} == {key: entry["rule"] for key, entry in old.items()}


ONE_CHILD = """\
mimoc: 1
name: one
age_months: 9
body:
  hands: five_finger
  individual:
    sex: female
    length_percentile: 25
    weight_kg: 7.4
  measurements:
    foot_length_cm: 11.2
    left_forearm_circumference_cm: 13.0
    left_upper_arm_circumference_cm: 14.0
    right_upper_arm_circumference_cm: 14.0
    thumb_diameter_cm: 1.0
  parts:
    right_upper_arm: {length: 0.95, girth: 1.05}
    head: {girth: 1.02}
  remove: [right_hand]
"""


@pytest.fixture(scope="module")
def one_child() -> mimoc.Bundle:
    return mimoc.build(read_spec(parse(ONE_CHILD, "one.yaml")))


@pytest.fixture(scope="module")
def told(one_child) -> dict[str, dict]:
    return entries_of(one_child)


def behind(entries: dict[str, dict], key: str) -> set[str]:
    return {key}.union(*(behind(entries, source) for source in entries[key].get("from", ())))


def test_every_override_is_explained_to_its_line(one_child, told):
    lines = ONE_CHILD.splitlines()
    for name in ("foot_length", "left_forearm_circumference", "thumb_diameter"):
        entry, key = told[f"measurements.{name}_cm"], f"spec.body.measurements.{name}_cm"
        assert (entry["rule"], entry["from"]) == ("given by the spec", [key])
        assert told[key]["value"] == pytest.approx(entry["value"])
        line, column = map(int, told[key]["rule"].split(":")[1:])
        assert lines[line - 1].strip().startswith(f"{name}_cm: ")
        assert lines[line - 1][column - 1 :] == f"{told[key]['value']}"
    text = "\n".join(line for number in _all(explain(one_child, "body.left_foot.mass")) for line in number.lines)
    assert "given by the spec" in text
    assert "spec.yaml:11:21" in text


def _all(explanation):
    return [explanation, *(deeper for source in explanation.sources for deeper in _all(source))]


def test_every_key_about_the_body_is_behind_some_number(told):
    numbers = [key for key in told if key.startswith(("geom.", "body."))]
    reached = set().union(*(behind(told, key) for key in numbers))
    said = {key for key in told if key.startswith("spec.body.") and told[key]["rule"] != "default"}
    said -= {"spec.body.hands", "spec.body.remove"}
    assert {key for key in said if key not in reached} == set()
    assert len(said) == 11


def test_a_side_comes_from_its_own_measurement(told):
    assert "measurements.left_forearm_circumference_cm" in told["geom.left_larm.size"]["from"]
    assert "measurements.forearm_circumference_cm" in told["geom.right_larm.size"]["from"]
    both = {f"measurements.{side}_upper_arm_circumference_cm" for side in ("left", "right")}
    assert both <= set(told["geom.ub3.size"]["from"]), "the girdle is between both arms"


def test_the_factors_of_a_part_are_behind_it_and_what_is_attached(told):
    factors = {f"spec.body.parts.right_upper_arm.{key}" for key in ("length", "girth")}
    for key in ("geom.right_uarm1.size", "geom.right_uarm1.mass", "body.right_upper_arm.mass"):
        assert factors <= behind(told, key), key
    assert factors <= set(told["body.right_lower_arm.pos"]["from"])
    assert factors <= behind(told, "actuator.act:right_shoulder_abduction.gear")
    assert not factors & behind(told, "geom.left_uarm1.size")
    assert not factors & behind(told, "actuator.act:right_elbow.gear")


def test_the_factor_of_an_individual_is_told_with_what_asked_for_it(told):
    asked = {f"spec.body.individual.{key}" for key in ("sex", "length_percentile", "weight_kg")}
    factor = re.compile(r"x (\d\.\d{4}) for this child$")
    found = {}
    for name in ("crown_sole_length", "head_circumference", "calf_circumference", "hip_breadth"):
        entry = told[f"measurements.{name}_cm"]
        found[name] = float(factor.search(entry["rule"].split(":")[1])[1])
        assert asked | {"spec.age_months"} == set(entry["from"])
        fit = entry["fit"]
        fit_cm = fit["a"] * np.log(9 + fit["b"]) + fit["c"] + fit["d"] * 9
        assert entry["value"] == pytest.approx(found[name] * fit_cm, rel=1e-4)
    assert found["crown_sole_length"] == found["head_circumference"] != found["calf_circumference"]


def test_nothing_is_told_of_what_is_absent(told):
    assert not any("right_hand" in key or "right_ff" in key for key in told if not key.startswith("spec."))
