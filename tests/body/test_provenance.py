"""Every number of a body says where it comes from, and says the number that is in the model."""

import json
import re
from graphlib import TopologicalSorter

import numpy as np
import pytest
from lxml import etree

from mimoc.fits.tables import data_files

AGES_MONTHS = (0, 5.25, 18, 24)
JOINT_CONSTANTS = ("range", "stiffness", "damping", "frictionloss", "armature", "springref")
TABLE_ROW = re.compile(r"anthrokids\.csv:(\d+)")


@pytest.fixture(params=AGES_MONTHS)
def bundle(request, bundle_at):
    return bundle_at(request.param)


@pytest.fixture
def entries(bundle) -> dict[str, dict]:
    return json.loads(bundle.files["provenance.json"])


def written(bundle, pointer: str) -> list[float]:
    """Return the numbers of the attributes that a pointer such as `infant.xml: geom[@name='head']/@size` leads to."""
    file, path = pointer.split(": ", 1)
    attributes = etree.fromstring(bundle.files[file]).xpath(f"//{path}")
    return [[float(word) for word in text.split()] for text in attributes]


def test_every_number_is_the_one_in_the_xml(bundle, entries):
    """A part's mass is the sum of its geoms', all others stand there as they are."""
    pointers = {key: entry["xml"] for key, entry in entries.items() if "xml" in entry}
    assert len(pointers) > 500
    for key, pointer in pointers.items():
        found, value = written(bundle, pointer), entries[key]["value"]
        assert found, key
        assert np.sum(found, axis=0) == pytest.approx(value, rel=1e-8), key
        assert len(found) == 1 or key.endswith(".mass"), key


def test_every_number_that_counts_has_an_entry(bundle, entries, infant_at):
    model = infant_at(bundle.manifest.child.age_months).model
    for index in range(1, model.nbody):
        body = model.body(index)
        assert entries[f"body.{body.name}.mass"]["value"] == pytest.approx(body.mass[0], rel=1e-8)
    for index in range(1, model.njnt):
        joint = model.joint(index)
        assert entries.keys() >= {f"joint.{joint.name}.{constant}" for constant in JOINT_CONSTANTS}
        assert entries[f"joint.{joint.name}.range"]["value"] == pytest.approx(joint.range)
        assert entries[f"joint.{joint.name}.armature"]["value"] == joint.armature[0]
    for index in range(model.nu):
        actuator = model.actuator(index)
        assert entries[f"actuator.{actuator.name}.gear"]["value"] == pytest.approx(actuator.gear[0])
        assert entries[f"actuator.{actuator.name}.forcerange"]["value"] == pytest.approx(actuator.forcerange)


def test_every_geom_of_the_body_has_its_size_place_and_mass(bundle, entries, infant_at):
    infant = infant_at(bundle.manifest.child.age_months)
    for name in infant.geoms(*(infant.model.body(index).name for index in range(1, infant.model.nbody))):
        size = entries[f"geom.{name}.size"]["value"]
        assert infant.model.geom(name).size[: len(size)] == pytest.approx(size, rel=1e-8), name
        assert infant.model.geom(name).pos == pytest.approx(entries[f"geom.{name}.pos"]["value"], abs=1e-9), name
        assert f"geom.{name}.mass" in entries


def test_sources_exist_and_never_lead_in_a_circle(entries):
    graph = {key: entry.get("from", ()) for key, entry in entries.items()}
    assert {source for sources in graph.values() for source in sources} <= graph.keys()
    assert len(list(TopologicalSorter(graph).static_order())) == len(entries)


def test_every_entry_ends_in_the_spec_or_in_the_reference_body(entries):
    """And everything that grows ends in the age."""
    for key, entry in entries.items():
        assert entry["rule"], key
        if not entry.get("from"):
            assert key.startswith("spec.") or "MIMo's reference body" in entry["rule"], key
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
            found_cm = fit["a"] * np.log(age_months + fit["b"]) + fit["c"]
            assert entry["value"] == pytest.approx(found_cm, rel=1e-7), key


def test_rules_are_the_same_at_every_age(bundle_at):
    """Only values, and the place in the spec, depend on the infant."""
    young, old = (json.loads(bundle_at(age).files["provenance.json"]) for age in (0, 24))
    assert {key: entry["rule"] for key, entry in young.items()} == {key: entry["rule"] for key, entry in old.items()}
