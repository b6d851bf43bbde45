"""What pages are made of: words, axes, outlines and escaped texts."""

import math

import numpy as np
import pytest
from hypothesis import given, strategies as st

import mimoc
from mimoc.base.quantities.child import AGE
from mimoc.base.units import cm_to_m
from mimoc.bundle.model import load_model
from mimoc.render.plots.drawing import around, draw_svg, ticks
from mimoc.render.plots.plot import Dots, Plot
from mimoc.studies.reporting import words
from mimoc.studies.reporting.infant.sources import Sources
from mimoc.studies.reporting.infant.strength import strength
from mimoc.studies.reporting.page import Cell, Code, Details, Page, Section, TextBlock, render, table
from mimoc.studies.reporting.silhouette import silhouette

from .conftest import Seen

NUMBERS = st.floats(-1e6, 1e6).map(lambda value: round(value, 6))
TEXTS = st.text(
    st.characters(codec="utf-8", exclude_categories=["Cc", "Cs", "Zs", "Zl", "Zp"]), min_size=1, max_size=12
)


@given(TEXTS)
def test_whatever_a_text_holds_is_shown_as_it_is(text):
    blocks = (TextBlock(text), Code(text), Details(text, (TextBlock(text),)), table((text,), [(Cell(text),)]))
    seen = Seen(render(Page(text, text, (text,), (Section("place", text, blocks),), text)).decode())
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
    seen = Seen(render(Page("", "", (), (section,), "")).decode())
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
