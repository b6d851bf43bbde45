"""What is true of every page, and what each kind of page tells."""

import base64
import io
import math
import shutil
from itertools import product

import numpy as np
import pytest
from hypothesis import given, strategies as st
from PIL import Image

import mimoc
from mimoc.base.quantities import AGE
from mimoc.base.units import cm_to_m
from mimoc.bundle.model import load_model
from mimoc.compiler.provenance import who_percentiles
from mimoc.render.drawing import around, draw_svg, ticks
from mimoc.render.plots import Dots, Plot
from mimoc.studies.cohorts.cohort import Cohort
from mimoc.studies.cohorts.store import Result, Store, finished_jobs
from mimoc.studies.cohorts.table import rows_of
from mimoc.studies.reporting import infant, words
from mimoc.studies.reporting.body import silhouette, strength
from mimoc.studies.reporting.page import Cell, Code, Details, Page, Section, TextBlock, render, table
from mimoc.studies.reporting.sources import Sources
from mimoc.studies.reporting.words import THIN_SPACE
from mimoc.training.run_folder import open_run_folder
from mimoc.training.settings import TrainingSettings

from .conftest import STUDY, Seen, _no_opengl

PAGES = {"page": "small_one", "world_page": "pair", "run_page": "run", "cohort_page": "cohort"}
"""What each page is made from."""
MAX_BYTES = 1_000_000


@pytest.fixture(params=PAGES)
def any_page(request):
    return request.getfixturevalue(request.param)


def test_a_page_is_well_formed_light_and_needs_nothing_else(any_page, see):
    seen = see(any_page)
    assert any_page.stat().st_size < MAX_BYTES
    assert not {tag for tag, _ in seen.tags} & {"script", "link", "iframe", "object", "embed", "use", "image"}
    assert all(source.startswith("data:") for source in seen.attributes("src"))
    assert not any(word in seen.html for word in ("url(", "@import", "http:", "https:", "onload"))
    assert "default-src 'none'" in seen.html


def test_every_reference_on_a_page_leads_somewhere(any_page, see):
    seen = see(any_page)
    places, references = seen.attributes("id"), seen.attributes("href")
    assert len(references) > 3
    assert len(set(places)) == len(places)
    assert {reference.removeprefix("#") for reference in references} <= set(places)


def test_every_drawing_says_what_it_shows(any_page, see):
    drawings = [attributes for tag, attributes in see(any_page).tags if tag == "svg"]
    assert len(drawings) > 3
    assert all(each["role"] == "img" and each["aria-label"] for each in drawings)


@pytest.mark.parametrize("name", ["run", "cohort"])
def test_the_same_source_gives_the_same_bytes(name, request, tmp_path, without_opengl):
    again = mimoc.report(request.getfixturevalue(name), tmp_path / "again.html")
    assert again.read_bytes() == request.getfixturevalue(f"{name}_page").read_bytes()


def test_a_spec_and_its_bundle_give_the_same_page(small_one, page, tmp_path, without_opengl):
    (tmp_path / "infant.yaml").write_bytes(small_one.files["spec.yaml"])
    assert mimoc.report(tmp_path / "infant.yaml", tmp_path / "page.html").read_bytes() == page.read_bytes()


def test_a_world_has_a_section_for_each_infant_and_what_they_touch(world_page, page, pair, see):
    seen = see(world_page)
    assert {"anna", "ben", "contacts", "stability", "spec"} <= set(seen.attributes("id"))
    assert "Anna (9 months) and Ben (6 months) share one world" in seen.text
    first, _ = (row for row in seen.rows if row[:1] == ["Touch"])
    assert first[1] == see(page).row("Touch")[1], "Anna's, as it is without Ben"
    assert seen.text.count("Beside the healthy child") == 1
    forces = {tuple(row[:2]): float(row[2]) for row in seen.rows if len(row) == 3 and row[1].startswith("Ben's ")}
    assert forces["Anna's left foot", "Ben's right foot"] > 0.1
    assert all(force > 0 for force in forces.values())


def test_the_page_of_a_training_on_a_world_has_its_infants(pair, tmp_path, see, monkeypatch):
    monkeypatch.setattr(infant, "world_portrait", _no_opengl)
    with open_run_folder(tmp_path / "run", TrainingSettings.choose("ppo", 4096, 3, 2, 1024, {}), pair, force=False):
        pass
    seen = see(mimoc.report(tmp_path / "run", tmp_path / "run.html"))
    assert {"curves", "settings", "anna", "ben"} <= set(seen.attributes("id"))


def test_the_size_of_a_child_is_told_in_words(page, small_one, see):
    text, child = see(page).text, small_one.manifest.child
    assert f"A girl of 9 months, {child.length_cm:.1f}{THIN_SPACE}cm long" in text
    percentiles = who_percentiles(child)
    assert f"about {percentiles['length_cm']:.0f} of 100 girls of 9 months are shorter" in text
    assert f"about {percentiles['weight_kg']:.0f} of 100 girls of 9 months are lighter" in text


def test_masses_torques_and_delays_are_those_of_the_bundle(page, small_one, see):
    seen, torques = see(page), mimoc.torque_limits(small_one)
    assert seen.row("The whole body")[1] == f"{1000 * small_one.manifest.child.weight_kg:.0f}"
    low, high = torques["robot:left_knee"]
    assert seen.row("Knee")[1] == f"{-low:.2g} / {high:.2g}{THIN_SPACE}N{THIN_SPACE}m"
    felt = seen.row("Touch")
    points = sum(skin.points for skin in small_one.manifest.senses.touch.skin)
    assert f"at {points:,} points of its skin" in felt[1]
    assert (
        felt[3]
        == f"{small_one.manifest.delays.touch.ms:g} ms, {small_one.manifest.delays.touch.legs_ms:g} ms from the legs"
    )
    assert seen.row("Proprioception")[4] == "SD 1.5°"


def test_an_infant_is_checked_in_each_of_its_poses(page, small_one, see):
    found = {row[0].lower(): row[1] for row in see(page).rows if row[1:2] in (["stable"], ["not stable"])}
    assert found == dict.fromkeys(small_one.manifest.poses, "stable")


def test_a_number_leads_back_to_the_line_of_the_spec(page, see):
    seen = see(page)
    assert "#n-child.length_cm" in seen.attributes("href")
    (rule,) = (row[2] for row in seen.rows if row[0] == "spec.body.individual.length_percentile")
    assert rule.startswith("spec.yaml:")


def test_a_page_has_a_portrait_or_says_why_not_and_so_with_the_check(small_one, page, tmp_path, see):
    assert "no OpenGL" in see(page).text
    assert "Not checked" not in see(page).text
    mimoc.write_bundle(small_one, tmp_path / "folder")
    drawn = see(mimoc.report(tmp_path / "folder", tmp_path / "drawn.html", check=False))
    assert "Not checked" in drawn.text
    (source,) = drawn.attributes("src")
    picture = Image.open(io.BytesIO(base64.b64decode(source.partition("base64,")[2])))
    assert picture.size == (800, 600)
    assert "no OpenGL" not in drawn.text


def test_the_page_of_a_training_has_its_curves_settings_and_versions(run_page, see):
    seen = see(run_page)
    assert "50 % of" in seen.text
    assert seen.row("Control steps of training")[1:] == ["1,024", "2,048"]
    assert seen.row("Control steps")[1:] == ["4,096"]
    assert seen.row("Share of episodes that succeed")[1:] == ["0", "0.375"]
    assert seen.row("gamma") == ["gamma", "0.9", "0.98"]
    assert seen.row("mujoco")[1]
    assert "A girl of 9 months" in seen.text


def test_a_training_before_its_first_checkpoint_has_no_curves(run, tmp_path, without_opengl, see):
    shutil.copytree(run, tmp_path / "run")
    (tmp_path / "run" / "curve.csv").unlink()
    assert "no learning curve yet" in see(mimoc.report(tmp_path / "run", tmp_path / "page.html")).text


def test_the_page_of_a_cohort_tells_what_was_done_and_what_failed(cohort_page, see):
    seen = see(cohort_page)
    assert ["run", "2", "1"] in seen.rows
    (failed,) = (row for row in seen.rows if row[1:3] == ["1", "the floor <b>gave way</b>"])
    assert (failed[0], failed[4].startswith("logs/")) == ("run", True)
    assert [row for row in seen.rows if row[:1] == ["build"]] == [["build", "6", "0"]]
    assert "Length [cm] by age [months]" in " ".join(seen.attributes("aria-label"))
    assert "1 of the 6 bodies that were built" in seen.text


GIVEN = ((None, "length_percentile", "length_cm"), (None, "weight_percentile", "weight_kg"))
HEADS = (None, "head_percentile", "head_circumference_cm")
MEASURED = {"length_cm": (70.0, 74.5), "weight_kg": (8.0, 9.5), "head_circumference_cm": (44.0, 46.0)}


@pytest.mark.parametrize("keys", [keys for keys in product(*GIVEN, HEADS) if any(keys)], ids=str)
def test_children_given_in_any_way_are_drawn_by_what_they_have(keys, tmp_path, see):
    """Length against weight and head, in the units that each is given in; without a length nothing."""
    length, *others = keys
    children = [
        {"sex": sex} | {key: MEASURED.get(key, (20.0, 70.0))[number] for key in keys if key}
        for number, sex in enumerate(("female", "male"))
    ]
    study, store = Cohort({**STUDY, "children": children}), Store(tmp_path / "folder")
    store.create("spring")
    for job in study.jobs():
        store.write(job, Result("ok", {"length_cm": 70.0}, {}))
    seen = see(mimoc.report(store.folder, tmp_path / "page.html"))
    scatters = [title for title in seen.attributes("aria-label") if title.endswith("of 2 children")]
    assert len(scatters) == sum(1 for other in others if other and length)


def test_with_its_file_the_missing_jobs_of_a_cohort_are_counted(cohort, study, tmp_path, see):
    seen = see(mimoc.report(cohort, tmp_path / "page.html", cohort=study))
    assert ["run", "2", "1", "3"] in seen.rows
    assert "3 not done yet" in seen.text


def test_what_is_in_the_folder_is_what_the_cohort_knows(cohort, study):
    store = Store(cohort)
    jobs, damaged = finished_jobs(store)
    known = [job.key for job in study.jobs() if store.read(job) is not None]
    assert (sorted(job.key for job in jobs), damaged) == (sorted(known), ())
    rows = {row["job"]: row for row in study.rows(cohort)}
    for row in rows_of(jobs, store, ()):
        assert all(rows[row["job"]][name] == value for name, value in row.items())


def test_factors_that_are_left_out_are_named(cohort, tmp_path, see, monkeypatch):
    monkeypatch.setattr("mimoc.studies.reporting.cohort.MAX_FACTORS", 1)
    text = see(mimoc.report(cohort, tmp_path / "page.html")).text
    assert "Each measure is drawn by at most 1 factors; these are left out: sex" in text


def test_a_damaged_result_is_told_of(cohort, tmp_path, see):
    shutil.copytree(cohort, tmp_path / "cohort")
    next((tmp_path / "cohort" / "results").glob("*/*.json")).write_text("{")
    text = see(mimoc.report(tmp_path / "cohort", tmp_path / "page.html")).text
    assert "1 result cannot be read" in text


@pytest.mark.parametrize(
    ("source", "message"),
    [
        ("nowhere", "there is no such folder; name a folder written by"),
        ("empty", "neither an infant, a training run nor a cohort"),
        ("file.txt", "neither an infant, a training run nor a cohort"),
        ("damaged", "manifest.json was changed"),
        ("run", "run.json: file is damaged"),
        ("curve", "curve.csv: file is damaged"),
        ("bad.yaml", "age_months: 99 is too large"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(source, message, invoke, tmp_path, monkeypatch, request):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "empty").mkdir()
    (tmp_path / "file.txt").write_text("")
    (tmp_path / "bad.yaml").write_text("mimoc: 1\nname: bad\nage_months: 99\n")
    if source == "damaged":
        mimoc.write_bundle(request.getfixturevalue("small_one"), "damaged")
        (tmp_path / "damaged" / "manifest.json").write_text("{}")
    if source in ("run", "curve"):
        shutil.copytree(request.getfixturevalue("run"), source)
        (tmp_path / source / ("run.json" if source == "run" else "curve.csv")).write_text("steps\n{")
    outcome = invoke("report", source, "-o", "page.html")
    assert (outcome.code, outcome.out) == (2, "")
    assert message in outcome.err
    assert len(outcome.err.splitlines()) == 1
    assert not (tmp_path / "page.html").exists()


@pytest.mark.parametrize(("name", "message"), [("page.txt", "end it in .html"), ("no/page.html", "there is no folder")])
def test_a_page_that_cannot_be_written_is_one_line(name, message, invoke, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    outcome = invoke("report", "-", "-o", name, piped="mimoc: 1\nname: one\nage_months: 1\n")
    assert (outcome.code, outcome.out) == (2, "")
    assert message in outcome.err
    assert list(tmp_path.iterdir()) == []


def test_the_command_prints_where_the_page_is(cohort, invoke, tmp_path):
    page = tmp_path / "page.html"
    assert invoke("report", cohort, "-o", page)[:2] == (0, f"{page}\n")


def test_only_a_cohort_has_a_file_of_a_cohort(run, study, tmp_path):
    with pytest.raises(mimoc.MimocError, match=f"^{run}: not the folder of a cohort"):
        mimoc.report(run, tmp_path / "page.html", cohort=study)


NUMBERS = st.floats(-1e6, 1e6).map(lambda value: round(value, 6))
TEXTS = st.text(
    st.characters(codec="utf-8", exclude_categories=["Cc", "Cs", "Zs", "Zl", "Zp"]), min_size=1, max_size=12
)


@given(TEXTS)
def test_whatever_a_text_holds_is_shown_as_it_is(text):
    blocks = (TextBlock(text), Code(text), Details(text, (TextBlock(text),)), table((text,), [(Cell(text),)]))
    seen = Seen(render(Page(text, text, (text,), (Section("place", text, blocks),), made_by=text)).decode())
    assert seen.text.count(text) >= 10
    assert seen.rows == [[text], [text]]


@given(st.lists(NUMBERS, min_size=1, max_size=5))
def test_an_axis_holds_its_values_and_a_few_round_ticks(values):
    low, high = around(values)
    assert low < min(values) <= max(values) < high
    marks = ticks(low, high)
    assert 2 <= len(marks) <= 7
    assert all(low - 1e-6 * (high - low) <= value <= high + 1e-6 * (high - low) for value, _ in marks)
    assert len({text for _, text in marks}) == len(marks)


@given(st.integers(0, 24), st.integers(0, 24))
def test_more_is_farther_right_and_up(one, other):
    plot = Plot(AGE, AGE, dots=(Dots((one, other), (one, other)),), x_range=(0.0, 24.0), y_range=(0.0, 24.0))
    first, second = (dict(shape.places) for shape in draw_svg(plot).shapes if shape.tag == "circle")
    is_right, is_up = float(first["cx"]) <= float(second["cx"]), float(first["cy"]) >= float(second["cy"])
    assert (is_right and is_up) == (one <= other)


@pytest.mark.parametrize(
    ("percentile", "told"),
    [
        (0.2, "unusually short: fewer than 1 of 100 boys of 3 months is shorter"),
        (1.2, "unusually short: about 1 of 100 boys of 3 months is shorter"),
        (10.0, "rather short: about 10 of 100 boys of 3 months are shorter"),
        (50.4, "usual: about 50 of 100 boys of 3 months are shorter"),
        (90.0, "rather long: about 90 of 100 boys of 3 months are shorter"),
        (99.8, "unusually long: more than 99 of 100 boys of 3 months are shorter"),
    ],
)
def test_a_percentile_is_told_as_how_many_have_less(percentile, told):
    assert words.rank("length_cm", percentile, "male", 3) == told


def test_newborns_and_children_of_a_month_are_called_so():
    assert words.rank("weight_kg", 50, None, 0).endswith("of 100 children at birth are lighter")
    assert (words.age(1), words.age(9.5)) == ("1 month", "9.5 months")


@given(st.floats(1e-5, 1e6))
def test_a_figure_is_right_to_its_digits(value):
    assert float(words.figure(value, 3).replace(",", "")) == pytest.approx(value, rel=5e-3)
    assert words.figure(-value, 3) == words.MINUS + words.figure(value, 3)


def test_what_is_not_a_number_is_a_dash():
    assert words.figure(math.nan) == words.NOTHING


def test_an_outline_is_as_tall_as_the_child_and_the_same_on_both_sides(bundle_at):
    outline = silhouette(load_model(bundle_at(9)))
    assert outline.height_m == pytest.approx(cm_to_m(bundle_at(9).manifest.child.length_cm), abs=1e-3)
    points = np.concatenate(outline.outlines_m)
    assert -points[:, 0].min() == pytest.approx(points[:, 0].max(), abs=1e-4)
    assert outline.half_width_m == pytest.approx(points[:, 0].max(), abs=1e-4)


def test_a_limb_that_is_missing_is_neither_drawn_nor_weighed():
    spec = {"mimoc": 1, "name": "one_arm", "age_months": 9, "body": {"remove": ["left_upper_arm"]}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(spec))
    section = strength(bundle, load_model(bundle), Sources(bundle))
    seen = Seen(render(Page("", "", (), (section,))).decode())
    parts = {row[0] for row in seen.rows if row}
    assert {"Right upper arm", "Right hand", "Thigh, each"} <= parts
    assert not {"Left upper arm", "Upper arm, each"} & parts


def test_a_page_shows_the_joints_of_a_weak_side_beside_the_healthy_ones(tmp_path):
    weak = mimoc.InfantSpec(mimoc=1, name="kim", age_months=6, impairments={"weakness": {"right_arm": 0.5}})
    page = mimoc.report(weak, tmp_path / "kim.html", check=False, beside="healthy").read_text(encoding="utf-8")
    section = page.split("Beside the healthy child")[-1].split("</table>")[0]
    assert "Right elbow" in section
    assert "Left elbow" not in section
    assert "right 0." in page
