import numpy as np
import pytest

from mimoc.render.plots.curves import Curve, Panel, draw_panels
from mimoc.render.plots.figure import png

RISING = Curve("rising", (0, 1, 2), (0, 1, 4))
FALLING = Curve("falling", (0, 1, 2), (4, 1, 0), marker="o", joined=False)


def panel(*curves, **options) -> Panel:
    return Panel("Time [s]", "Angle [deg]", curves, **options)


def texts(legend) -> list[str]:
    return [text.get_text() for text in legend.get_texts()]


def test_every_curve_is_drawn_as_it_is():
    (axes,) = draw_panels([panel(RISING, FALLING, title="Both")]).axes
    drawn = {line.get_label(): line for line in axes.lines}
    for curve in (RISING, FALLING):
        assert [tuple(point) for point in drawn[curve.label].get_xydata()] == list(zip(curve.x, curve.y, strict=True))
    assert (drawn["rising"].get_linestyle(), drawn["falling"].get_linestyle()) == ("-", "None")
    assert (axes.get_xlabel(), axes.get_ylabel(), axes.get_title("left")) == ("Time [s]", "Angle [deg]", "Both")


def test_panels_with_the_same_labels_share_one_legend():
    figure = draw_panels([panel(RISING, FALLING), panel(RISING, FALLING)])
    assert [texts(legend) for legend in figure.legends] == [["rising", "falling"]]
    assert [axes.get_legend() for axes in figure.axes] == [None, None]


def test_panels_with_labels_of_their_own_have_legends_of_their_own():
    figure = draw_panels([panel(RISING, FALLING, RISING), panel(RISING)])
    assert figure.legends == []
    assert texts(figure.axes[0].get_legend()) == ["rising", "falling"]
    assert figure.axes[1].get_legend() is None


def test_curves_of_one_label_have_one_colour_and_others_another():
    (axes,) = draw_panels([panel(RISING, FALLING, RISING)]).axes
    first, second, third = (line.get_color() for line in axes.lines)
    assert first == third != second


def test_a_spread_is_a_band_about_its_curve():
    banded = Curve("mean", (0, 1), (1, 2), band=((0, 1), (2, 3)))
    (axes,) = draw_panels([panel(banded)]).axes
    (band,) = axes.collections
    assert np.ptp(band.get_paths()[0].vertices, axis=0) == pytest.approx((1, 3))


def test_a_level_and_a_ring_are_marked():
    (axes,) = draw_panels([panel(RISING, level=3.0, ring=2.0)]).axes
    _, level, ring = axes.lines
    assert set(level.get_ydata()) == {3.0}
    assert np.linalg.norm(ring.get_xydata(), axis=1) == pytest.approx(2.0)


def test_axes_can_be_logarithmic_or_those_of_a_map():
    logarithmic, equal = draw_panels([panel(RISING, logarithmic=True), panel(RISING, equal=True)]).axes
    assert logarithmic.get_xscale() == "log"
    assert equal.get_aspect() == 1


def test_the_same_panels_give_the_same_bytes():
    one, other = (png(draw_panels([panel(RISING, FALLING)])) for _ in range(2))
    assert one == other
    assert one.startswith(b"\x89PNG")
