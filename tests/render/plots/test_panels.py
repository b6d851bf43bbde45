import numpy as np
import pytest

from mimoc.base.quantities import Quantity
from mimoc.render.plots.file import draw, encode
from mimoc.render.plots.plot import Band, Dots, Line, Plot, Sheet
from mimoc.studies.growth_plots import AgeRow, rows_sheet

TIME, ANGLE = Quantity("time_s", "Time", "s"), Quantity("angle_deg", "Angle", "deg")
RISING = Line((0, 1, 2), (0, 1, 4), "rising")
FALLING = Dots((0, 1, 2), (4, 1, 0), "falling")


def plot(*parts, **options) -> Plot:
    lines, dots = (tuple(part for part in parts if isinstance(part, kind)) for kind in (Line, Dots))
    return Plot(TIME, ANGLE, lines, dots=dots, **options)


def figure(*plots):
    return draw(Sheet(plots))


def texts(legend) -> list[str]:
    return [text.get_text() for text in legend.get_texts()]


def test_every_curve_is_drawn_as_it_is():
    (axes,) = figure(plot(RISING, FALLING, title="Both")).axes
    drawn = {line.get_label(): line for line in axes.lines}
    for part in (RISING, FALLING):
        assert [tuple(point) for point in drawn[part.label].get_xydata()] == list(zip(part.x, part.y, strict=True))
    assert (drawn["rising"].get_linestyle(), drawn["falling"].get_linestyle()) == ("-", "None")
    assert (axes.get_xlabel(), axes.get_ylabel(), axes.get_title("left")) == ("Time [s]", "Angle [deg]", "Both")


def test_panels_with_the_same_labels_share_one_legend():
    drawn = figure(plot(RISING, FALLING), plot(RISING, FALLING))
    assert [texts(legend) for legend in drawn.legends] == [["rising", "falling"]]
    assert [axes.get_legend() for axes in drawn.axes] == [None, None]


def test_a_shared_legend_is_no_wider_than_its_plots():
    lines = [Line((0, 1), (0, height), f"under condition {height}") for height in range(6)]
    drawn = figure(plot(*lines), plot(*lines))
    (legend,) = drawn.legends
    assert len(texts(legend)) == len(lines)
    assert legend.get_window_extent().width <= drawn.bbox.width


def test_panels_with_labels_of_their_own_have_legends_of_their_own():
    drawn = figure(plot(RISING, FALLING, RISING), plot(RISING))
    assert drawn.legends == []
    assert texts(drawn.axes[0].get_legend()) == ["rising", "falling"]
    assert drawn.axes[1].get_legend() is None


def test_curves_of_one_label_have_one_colour_and_others_another():
    (axes,) = figure(plot(RISING, FALLING, RISING)).axes
    first, second, other = (line.get_color() for line in axes.lines)
    assert first == second != other


def test_a_spread_is_a_band_about_its_curve():
    (axes,) = figure(plot(Line((0, 1), (1, 2), "mean"), bands=(Band((0, 1), (0, 1), (2, 3), "mean"),))).axes
    (band,) = axes.collections
    assert np.ptp(band.get_paths()[0].vertices, axis=0) == pytest.approx((1, 3))


def test_a_level_and_a_ring_are_marked():
    (axes,) = figure(plot(RISING, level=3.0, ring=2.0)).axes
    _, level, ring = axes.lines
    assert set(level.get_ydata()) == {3.0}
    assert np.linalg.norm(ring.get_xydata(), axis=1) == pytest.approx(2.0)


def test_axes_can_be_logarithmic_or_those_of_a_map():
    logarithmic, equal = figure(plot(RISING, logarithmic=True), plot(RISING, equal=True)).axes
    assert logarithmic.get_xscale() == "log"
    assert equal.get_aspect() == 1


def test_the_same_panels_give_the_same_bytes():
    one, other = (encode(Sheet((plot(RISING, FALLING),))) for _ in range(2))
    assert one == other
    assert one.startswith(b"\x89PNG")


ROWS = [AgeRow("sit", {"one": 6.0, "other": None}, (3.8, 5.9, 9.2)), AgeRow("rock", {"one": 5.5, "other": 7.0})]


def drawn():
    return draw(rows_sheet(ROWS, "real infants", ages_months=(0.0, 18.0))).axes[0]


def test_every_age_that_is_reached_has_a_mark_in_its_row():
    marks = {
        line.get_label(): list(zip(line.get_xdata(), map(round, line.get_ydata()), strict=True))
        for line in drawn().lines
        if line.get_label() in ("one", "other")
    }
    assert marks == {"one": [(6.0, 0), (5.5, 1)], "other": [(7.0, 1)]}


def test_usual_ages_are_bars_with_a_line_at_the_median_where_they_are_known():
    axes = drawn()
    (bar,) = axes.collections
    ages_months = bar.get_paths()[0].vertices[:, 0]
    assert (ages_months.min(), ages_months.max()) == (3.8, 9.2)
    assert [5.9, 5.9] in [list(line.get_xdata()) for line in axes.lines]


def test_rows_are_named_from_the_top():
    axes = drawn()
    assert [label.get_text() for label in axes.get_yticklabels()] == ["sit", "rock"]
    assert axes.get_ylim()[0] > axes.get_ylim()[1]
