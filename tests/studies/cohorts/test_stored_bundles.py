"""The bundles of a cohort, which share what they have in common."""

import mujoco
import pytest

import mimoc
from mimoc.base.errors import BundleError
from mimoc.compiler import explain
from mimoc.studies.cohorts import Cohort
from mimoc.studies.cohorts.run_jobs import run_jobs
from mimoc.studies.cohorts.store import Store, size_bytes

NUMBER = 3


@pytest.fixture(scope="module")
def built(tmp_path_factory):
    """Return a cohort whose infants are built, and its folder, which is only to be read."""
    base = {"mimoc": 1, "name": "infant", "age_months": 9, "senses": {"vestibular": {}}}
    keys = {"cohort": "small", "base": base, "children": {"draw": NUMBER}, "do": ["build"]}
    study, store = Cohort({"mimoc": 1, **keys}), Store(tmp_path_factory.mktemp("cohort"))
    store.create("small")
    run_jobs(study.jobs(), store)
    return study, store


def test_a_thousand_infants_take_less_than_100_megabytes(built):
    study, store = built
    shared = size_bytes(store.folder / "assets")
    each = (size_bytes(store.folder) - shared) / NUMBER
    assert shared + 1000 * each < 100e6
    links = {path.name: path.stat().st_nlink for path in store.bundle_folder(study.jobs()[0]).glob("assets/*.png")}
    assert len(links) > 5
    assert set(links.values()) == {NUMBER + 1}


def test_a_stored_bundle_opens_with_plain_mujoco_and_is_whole(built):
    study, store = built
    for job, spec in zip(study.jobs(), study.specs, strict=True):
        model = mujoco.MjModel.from_xml_path(str(store.bundle_folder(job) / "scene.xml"))
        alone = mimoc.build(spec.with_(body={"skin": False}))
        assert store.read_bundle(job).manifest == alone.manifest
        assert mimoc.make(store.read_bundle(job)).unwrapped.model.nq == model.nq


def test_the_provenance_of_a_stored_bundle_is_worked_out_again(built):
    study, store = built
    lean, whole = store.read_bundle(study.jobs()[0]), mimoc.build(study.specs[0])
    assert "provenance.json" not in lean.files
    key = "body.left_foot.mass"
    assert explain.explain(lean, key).lines == explain.explain(whole, key).lines


def test_a_stored_bundle_is_not_explained_by_another_version(built, monkeypatch):
    study, store = built
    lean = store.read_bundle(study.jobs()[0])
    monkeypatch.setattr("mimoc.compiler.building.Builder.files", {"infant.xml": b"another"})
    with pytest.raises(BundleError, match="builds another infant"):
        explain.contents(lean)
