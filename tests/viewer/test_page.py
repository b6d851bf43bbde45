"""What pages know of an infant is what mimoc builds, at every age; and they ask nothing of anybody else."""

import hashlib
import json
import re
from pathlib import Path

import mujoco
import numpy as np
import pytest
from hypothesis import given, settings as hypothesis_settings, strategies as st
from support import store
from support.pages import at_age, few_ages, read_page

import mimoc
from mimoc import fits
from mimoc.base.errors import MimocError
from mimoc.bundle.model import load_model
from mimoc.compiler.variants import SpecVariants
from mimoc.fits.standards import percentile
from mimoc.viewer import encoding as packing
from mimoc.viewer.page import describe, fill, page_of

CONFIGS = Path(__file__).parents[2] / "configs"
CHANGING = {
    "bodies": {"pos": "body_pos"},
    "joints": {"pos": "jnt_pos"},
    "geoms": {"pos": "geom_pos", "size": "geom_size"},
}
"""What places and sizes a page has by age, and MuJoCo's names of them."""


@pytest.fixture(scope="module")
def variants() -> SpecVariants:
    return SpecVariants(mimoc.load_spec(CONFIGS / "nine_months.yaml").with_(senses={"touch": {}}))


@pytest.fixture(scope="module")
def described(variants) -> dict:
    return describe(variants.original)


@pytest.fixture(scope="module")
def page(described) -> str:
    return fill(described)


@pytest.fixture(scope="module")
def known(page) -> dict:
    return read_page(page)


@given(age_months=st.floats(0, 24))
@hypothesis_settings(max_examples=12)
def test_between_its_ages_a_page_is_off_by_less_than_a_quarter_of_a_millimetre(known, variants, age_months):
    model = variants(float(np.round(age_months, 6)), 0).model
    for kind, arrays in CHANGING.items():
        for name, of_mujoco in arrays.items():
            whole = getattr(model, of_mujoco)
            theirs = whole[-len(known[kind]["names"]) :]  # The infant comes after the world, and so do its parts.
            found = at_age(known["ages_months"], known[kind][name], age_months)
            assert np.abs(found - theirs).max() < 0.25e-3, (kind, name)
    limits = at_age(known["ages_months"], known["joints"]["range"], age_months)
    assert np.degrees(np.abs(limits - model.jnt_range[1:])).max() < 0.1


@given(age_months=st.floats(0, 24))
@hypothesis_settings(max_examples=5)
def test_touch_points_are_off_by_less_than_a_millimetre_and_a_half(known, variants, age_months):
    bundle = variants(float(np.round(age_months, 6)), 0).bundle
    found = at_age(known["touch"]["ages_months"], known["touch"]["points"], age_months)
    assert np.linalg.norm(found - bundle.arrays["touch/points_m"], axis=1).max() < 1.5e-3


def test_curves_are_whos_and_the_dot_is_the_child(known, variants):
    standard = fits.load_tables().who["length_cm"]
    chart = known["standards"]["charts"]["length_cm"]
    plot = chart["plot"]
    (outer, inner), (median, own) = plot["bands"], plot["lines"]
    curves = (outer["low"], inner["low"], median["y"], inner["high"], outer["high"])
    for curve, share in zip(curves, known["standards"]["percentiles"], strict=True):
        scores = [standard.z_score(float(curve[row]), float(median["x"][row]), "mean") for row in (0, 18, 48)]
        assert [percentile(z) for z in scores] == pytest.approx([share] * 3, abs=0.01)
    at_nine = known["ages_months"].index(9)
    child = variants.original.manifest.child
    assert (plot["y"], own["look"]) == ({"label": "Length", "unit": "cm"}, "own")
    assert own["y"][at_nine] == pytest.approx(child.length_cm)
    assert chart["percentile"][at_nine] == pytest.approx(
        percentile(standard.z_score(child.length_cm, 9, "mean")), abs=1e-3
    )


def test_a_child_that_was_born_early_is_as_at_term_before():
    early = mimoc.InfantSpec.model_validate(
        {"mimoc": 1, "name": "kim", "age_months": 6, "impairments": {"gestation_weeks": 27.3}}
    )
    sizes = describe(mimoc.build(early))["geoms"]["size"]
    assert (sizes[0] == sizes[1]).all()
    assert (sizes[0] < sizes[-1]).any()


@pytest.mark.parametrize(
    ("impairments", "said"),
    [
        ({"range": {"left_elbow": [-10, -1]}}, "before 9 months"),
        ({"gestation_weeks": 30}, "before 2.3 months"),
        (None, ""),
    ],
)
def test_a_page_says_at_which_ages_there_is_no_such_child(impairments, said):
    """A newborn's elbow cannot be as straight as this contracture leaves it; the ages of this page are 0, 9 and 24."""
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 9, "impairments": impairments})
    with few_ages():
        (shown,) = re.findall(r'<p id="bounds">(.*?)</p>', page_of(mimoc.build(spec)))
    assert shown == (f"There is no such child {said}; it is shown as it is then." if said else "")


def test_a_page_asks_nothing_of_the_network(page):
    """Its own policy forbids it, and no address stands where something could be loaded from."""
    assert "default-src 'none'" in page
    assert not re.search(r"""(src|href)=["'](?!data:)|@import|url\((?!data:)""", page.partition("<script")[0])


def test_the_same_infant_gives_the_same_page(variants):
    with few_ages():
        assert page_of(variants.original) == page_of(variants.original)


def test_a_page_without_physics_is_smaller_than_a_megabyte_and_a_half(page):
    """Of which the program, before it is compressed, is less than one."""
    assert len(page.encode()) < 1.5e6
    assert len(packing.built("viewer.js")) < 1e6


def test_the_program_of_pages_was_built_from_its_present_source():
    """`make pages` builds it again and compares every byte."""
    names = sorted(entry.name for entry in (packing.FOLDER / "source").iterdir())
    sources = [packing.source(name) for name in names if name.endswith((".js", ".mjs", ".json"))]
    digest = hashlib.sha256("".join(sources).encode()).hexdigest()
    assert f"SHA-256 {digest} " in packing.built("viewer.js")[:200].decode()


def test_a_name_cannot_break_out_of_its_page(described):
    wicked = "</script><b>{{block}}"
    page = fill({**described, "name": wicked})
    assert wicked not in page
    assert read_page(page)["name"] == wicked


@pytest.mark.parametrize("config", ["one_arm", "playroom"])
def test_limbs_and_surroundings_are_those_of_the_spec(config):
    bundle = mimoc.build(CONFIGS / f"{config}.yaml")
    with few_ages():
        known = read_page(page_of(bundle))
    model = load_model(bundle)
    names = known["geoms"]["names"] + known["surroundings"]["geoms"]["names"]
    shown = [model.geom(index).name for index in range(model.ngeom) if model.geom_group[index] <= 2]
    assert set(shown) <= set(names)
    assert len(names) == len(set(names))


def test_a_program_that_was_not_built_is_one_clear_error(variants, monkeypatch, tmp_path):
    monkeypatch.setattr(packing, "FOLDER", tmp_path)
    with pytest.raises(MimocError, match=r"mimoc/viewer/.* is missing; in a checkout, `.ci/task viewer` builds it"):
        page_of(variants.original)


def test_a_page_has_no_furniture_and_no_caregiver_where_objects_do_not_suit_all_ages():
    scene = {"pose": "sitting", "start_at": "chair", "objects": [{"name": "chair", "kind": "seat"}]}
    scene["objects"].append({"name": "ball", "radius_cm": 3, "at": {"x_cm": 10, "z_cm": 10}})
    scene["caregiver"] = {"script": [{"do": "offer", "object": "ball"}]}
    spec = mimoc.InfantSpec.model_validate({"mimoc": 1, "name": "x", "age_months": 2, "scene": scene})
    with few_ages():
        known = describe(mimoc.build(spec))
    assert [name for name in known["surroundings"] if name == "object_chair"] == []


@pytest.fixture(scope="module")
def bundle() -> mimoc.Bundle:
    return store.built(CONFIGS / "nine_months.yaml")


@pytest.fixture(scope="module")
def pages(bundle) -> tuple[str, str]:
    data = describe(bundle, physics=True)
    return fill(data), fill({**data, "physics": None})


@pytest.fixture(scope="module")
def physics(pages) -> dict:
    return read_page(pages[0])["physics"]


def bare(described: dict) -> mujoco.MjModel:
    files = {name: content.tobytes() for name, content in described["files"].items()}
    return mujoco.MjModel.from_xml_string(described["scene"].tobytes().decode(), files)


def test_a_model_of_a_page_moves_as_the_bundle_does_to_the_bit(physics, bundle):
    (own,) = [model for model in physics["models"] if model["age_months"] == 9]
    moved = []
    for model in (bare(own), load_model(bundle)):
        model.opt.disableflags = 0  # The bundle's is prepared for this machine.
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("sitting").id)
        data.ctrl[:] = np.linspace(-1, 1, model.nu)
        mujoco.mj_step(model, data, 100)
        moved.append(data.qpos.copy())
    assert np.array_equal(*moved)


def test_models_of_a_page_have_no_pictures_and_are_of_many_ages(physics):
    ages = [described["age_months"] for described in physics["models"]]
    assert (ages[0], ages[-1], len(ages)) == (0, 24, 11)
    masses = [float(bare(described).body_mass.sum()) for described in physics["models"][::5]]
    assert masses == sorted(masses)
    assert bare(physics["models"][0]).ntex == 0


def test_what_is_commanded_is_what_an_action_commands(physics, bundle):
    env = mimoc.InfantEnv(bundle)
    assert env.action_space.shape == (len(physics["commanded"]),)
    assert physics["step_s"] == bundle.manifest.step_ms / 1000
    own = load_model(bundle)
    assert own.body(physics["bodies"][0]).name == bundle.manifest.root_body


def test_only_a_page_with_physics_contains_mujoco_and_its_licences(pages):
    page, plain = pages
    assert json.loads(re.findall(r'id="data">(.*?)</script>', plain, re.DOTALL)[0])["physics"] is None
    assert "Apache License" in page
    assert "Apache License" not in plain
    assert len(page) - len(plain) > 3e6
    assert "'unsafe-eval'" not in plain
