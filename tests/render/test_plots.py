import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from mimoc.base.errors import MissingExtraError, OutputError
from mimoc.base.quantities import INDICATORS, LEARNING, Quantity
from mimoc.render import plots
from mimoc.render.plots import Band, Dots, Line, Plot, Sheet, draw, encode, learning_sheet, write_sheet
from mimoc.studies.growth_plots import AgeRow, growth_sheet, measurements_sheet, rows_sheet

SIZE_PX = (1600, 1180)
SERIES = {
    "length_cm": [(0, 50.0), (12, 75.0), (24, 87.0)],
    "weight_kg": [(0, 3.3), (12, 9.3), (24, 11.8)],
    "head_circumference_cm": [(0, 34.2), (12, 45.5), (24, 47.7)],
    "arm_circumference_cm": [(3, 13.0), (12, 14.3), (24, 15.0)],
}


@pytest.fixture(scope="module")
def figure():
    """Return the figure of the series, which is only to be looked at."""
    return draw(growth_sheet(SERIES))


@pytest.fixture
def drawn(figure, monkeypatch) -> None:
    """Have that figure written, which need not be drawn again."""
    monkeypatch.setattr(plots, "draw", lambda sheet: figure)


def labelled(axes) -> dict[str, object]:
    handles, labels = axes.get_legend_handles_labels()
    return dict(zip(labels, handles, strict=True))


def test_the_picture_is_a_png_of_its_size(tmp_path):
    write_sheet(growth_sheet(SERIES), tmp_path / "growth.png")
    with Image.open(tmp_path / "growth.png") as picture:
        assert (picture.format, picture.size) == ("PNG", SIZE_PX)
    assert [path.name for path in tmp_path.iterdir()] == ["growth.png"]


def test_the_same_series_gives_the_same_bytes(tmp_path):
    for name in ("one.png", "two.png"):
        write_sheet(growth_sheet(SERIES), tmp_path / name)
    assert (tmp_path / "one.png").read_bytes() == (tmp_path / "two.png").read_bytes()


@pytest.mark.usefixtures("drawn")
def test_an_older_picture_is_replaced(tmp_path):
    (tmp_path / "growth.png").write_bytes(b"old")
    write_sheet(growth_sheet(SERIES), tmp_path / "growth.png")
    with Image.open(tmp_path / "growth.png") as picture:
        assert picture.size == SIZE_PX


def test_every_indicator_has_a_panel_with_its_unit(figure):
    axes = figure.axes
    assert [panel.get_ylabel() for panel in axes] == [quantity.title for quantity in INDICATORS.values()]
    assert all(panel.get_ylabel().endswith(("[cm]", "[kg]")) for panel in axes)


def test_the_infant_is_drawn_as_it_was_measured(figure):
    for panel, points in zip(figure.axes, SERIES.values(), strict=True):
        assert [tuple(point) for point in labelled(panel)["mimoc"].get_xydata()] == points


def test_the_legend_says_what_was_inferred(figure):
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == [
        "WHO, mean",
        "mimoc",
        "AnthroKids",
        "AnthroKids, inferred",
        "WHO, 5th to 95th percentile",
    ]


def test_only_the_birth_row_is_marked_as_inferred(figure):
    for panel in figure.axes:
        curves = labelled(panel)
        if "AnthroKids" in curves:
            assert list(curves["AnthroKids, inferred"].get_xdata()) == [0]
            assert list(curves["AnthroKids"].get_xdata()) == [1.5, 4.5, 7.5, 10.5, 14, 18, 22]


def test_who_band_spans_90_percent_of_boys_and_girls(figure):
    """At birth, 46.4 to 52.6 cm about 49.5 (WHO's tables: boys 46.8 to 53.0, girls 46.1 to 52.2)."""
    curves = labelled(figure.axes[0])
    at_birth = [y for x, y in curves["WHO, 5th to 95th percentile"].get_paths()[0].vertices if x == 0]
    assert (min(at_birth), max(at_birth)) == (pytest.approx(46.45, abs=0.1), pytest.approx(52.6, abs=0.1))
    assert curves["WHO, mean"].get_ydata()[0] == pytest.approx(49.52, abs=0.01)


def test_an_indicator_without_the_infant_still_has_its_standard():
    panel = draw(growth_sheet({})).axes[1]
    assert labelled(panel).keys() == {"WHO, 5th to 95th percentile", "WHO, mean"}


@pytest.mark.full
@pytest.mark.parametrize(
    ("suffix", "start"), [(".svg", b"<?xml"), (".pdf", b"%PDF"), (".jpg", b"\xff\xd8"), (".WEBP", b"RIFF")]
)
def test_the_name_says_the_format(suffix, start, tmp_path):
    for name in ("one", "two"):
        write_sheet(growth_sheet(SERIES), tmp_path / f"{name}{suffix}")
    one, two = ((tmp_path / f"{name}{suffix}").read_bytes() for name in ("one", "two"))
    assert one.startswith(start)
    assert one == two


@pytest.mark.parametrize("name", ["growth.doc", "growth", "growth.png.txt"])
def test_a_name_of_another_format_is_refused(name, tmp_path):
    with pytest.raises(OutputError, match=r"end it in \.png, "):
        write_sheet(growth_sheet(SERIES), tmp_path / name)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("drawn")
@pytest.mark.parametrize("place", ["missing/growth.png", "file.txt/growth.png", "folder.png", f"{'long' * 100}.png"])
def test_a_place_that_cannot_be_written_is_an_error_that_leaves_nothing(place, tmp_path):
    (tmp_path / "file.txt").write_text("mine")
    (tmp_path / "folder.png").mkdir()
    with pytest.raises(OutputError, match="cannot be written"):
        write_sheet(growth_sheet(SERIES), tmp_path / place)
    assert sorted(path.name for path in tmp_path.rglob("*")) == ["file.txt", "folder.png"]
    assert (tmp_path / "file.txt").read_text() == "mine"


@pytest.mark.usefixtures("drawn")
def test_an_older_picture_outlives_a_failure(tmp_path, monkeypatch):
    def fail(source: Path, target: Path) -> None:
        raise OSError(28, "No space left on device")

    (tmp_path / "growth.png").write_bytes(b"old")
    monkeypatch.setattr("os.replace", fail)
    with pytest.raises(OutputError, match="No space left"):
        write_sheet(growth_sheet(SERIES), tmp_path / "growth.png")
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"old"]


def test_a_missing_matplotlib_names_the_extra(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match=r"mimoc\[report\]"):
        write_sheet(growth_sheet(SERIES), tmp_path / "growth.png")
    assert list(tmp_path.iterdir()) == []


def test_every_measurement_has_a_small_plot_and_no_other_axes_are_drawn():
    series = {"hand_length": [(3, 7.0), (12, 9.0)], "foot_length": [(3, 9.0), (12, 11.0)]}
    panels = draw(measurements_sheet(series, 0.04)).axes
    assert [panel.get_title("left") for panel in panels] == ["Foot length [cm]", "Hand length [cm]"]
    assert labelled(panels[1]).keys() == {"AnthroKids", "curve", "mimoc"}


def test_pyplot_and_its_global_state_are_left_alone(tmp_path):
    imports = "from mimoc.render import plots; from mimoc.studies import growth_plots as growth"
    code = f"import sys; {imports}; plots.write_sheet(growth.growth_sheet({{}}), sys.argv[1]); print(*sys.modules)"
    modules = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "growth.png")], capture_output=True, text=True, check=True
    ).stdout.split()
    assert "matplotlib.figure" in modules
    assert "matplotlib.pyplot" not in modules


def curve(rows, offset=0.0):
    values = np.linspace(1, 0.2, rows) + offset
    return {"steps": np.arange(1, rows + 1) * 1000, **{quantity.curve: values for quantity in LEARNING}}


def test_each_column_has_a_panel_and_each_label_a_line():
    curves = {"0 ms": [curve(5), curve(5, 0.3)], "50 ms": [curve(3)]}
    figure = draw(learning_sheet(curves, {"success_rate": 0.9}, "random policy"))
    assert [axes.get_ylabel() for axes in figure.axes] == [quantity.title for quantity in LEARNING]
    assert [len(axes.lines) for axes in figure.axes] == [3, 2, 2, 2]
    assert [len(axes.collections) for axes in figure.axes] == [1] * 4


def test_the_line_is_the_mean_of_the_seeds_and_the_band_their_range():
    axes = draw(learning_sheet({"": [curve(5), curve(5, 0.5)]})).axes[0]
    np.testing.assert_allclose(axes.lines[0].get_ydata(), curve(5, 0.25)["success_rate"])
    band = axes.collections[0].get_paths()[0].vertices[:, 1]
    assert (band.min(), band.max()) == (pytest.approx(0.2), pytest.approx(1.5))


def test_where_nothing_is_known_nothing_is_drawn(recwarn):
    unknown = {**curve(3), "time_to_success_s": [np.nan, np.nan, 0.5]}
    axes = draw(learning_sheet({"": [unknown]})).axes[1]
    assert axes.lines[0].get_xdata().tolist() == [3000]
    assert not recwarn.list


def test_a_single_row_is_a_mark():
    axes = draw(learning_sheet({"": [curve(1)]})).axes[0]
    assert axes.lines[0].get_marker() == "o"


def test_a_picture_of_nothing_and_of_curves_of_unequal_lengths():
    for curves in ({}, {"": []}, {"": [curve(0)]}, {"a": [curve(4), curve(2)]}):
        assert encode(learning_sheet(curves)).startswith(b"\x89PNG")


def test_without_matplotlib_it_is_said_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "matplotlib.figure", None)
    with pytest.raises(MissingExtraError, match=r"pip install 'mimoc\[report\]'"):
        encode(learning_sheet({}))


TIME, ANGLE = Quantity("time_s", "Time", "s"), Quantity("angle_deg", "Angle", "deg")
RISING = Line((0, 1, 2), (0, 1, 4), "rising")
FALLING = Dots((0, 1, 2), (4, 1, 0), "falling")


def plot(*parts, **options) -> Plot:
    lines, dots = (tuple(part for part in parts if isinstance(part, kind)) for kind in (Line, Dots))
    return Plot(TIME, ANGLE, lines, dots=dots, **options)


def figure_of(*plots):
    return draw(Sheet(plots))


def texts(legend) -> list[str]:
    return [text.get_text() for text in legend.get_texts()]


def test_every_curve_is_drawn_as_it_is():
    (axes,) = figure_of(plot(RISING, FALLING, title="Both")).axes
    drawn = {line.get_label(): line for line in axes.lines}
    for part in (RISING, FALLING):
        assert [tuple(point) for point in drawn[part.label].get_xydata()] == list(zip(part.x, part.y, strict=True))
    assert (drawn["rising"].get_linestyle(), drawn["falling"].get_linestyle()) == ("-", "None")
    assert (axes.get_xlabel(), axes.get_ylabel(), axes.get_title("left")) == ("Time [s]", "Angle [deg]", "Both")


def test_panels_with_the_same_labels_share_one_legend():
    drawn = figure_of(plot(RISING, FALLING), plot(RISING, FALLING))
    assert [texts(legend) for legend in drawn.legends] == [["rising", "falling"]]
    assert [axes.get_legend() for axes in drawn.axes] == [None, None]


def test_a_shared_legend_is_no_wider_than_its_plots():
    lines = [Line((0, 1), (0, height), f"under condition {height}") for height in range(6)]
    drawn = figure_of(plot(*lines), plot(*lines))
    (legend,) = drawn.legends
    assert len(texts(legend)) == len(lines)
    assert legend.get_window_extent().width <= drawn.bbox.width


def test_panels_with_labels_of_their_own_have_legends_of_their_own():
    drawn = figure_of(plot(RISING, FALLING, RISING), plot(RISING))
    assert drawn.legends == []
    assert texts(drawn.axes[0].get_legend()) == ["rising", "falling"]
    assert drawn.axes[1].get_legend() is None


def test_curves_of_one_label_have_one_colour_and_others_another():
    (axes,) = figure_of(plot(RISING, FALLING, RISING)).axes
    first, second, other = (line.get_color() for line in axes.lines)
    assert first == second != other


def test_a_spread_is_a_band_about_its_curve():
    (axes,) = figure_of(plot(Line((0, 1), (1, 2), "mean"), bands=(Band((0, 1), (0, 1), (2, 3), "mean"),))).axes
    (band,) = axes.collections
    assert np.ptp(band.get_paths()[0].vertices, axis=0) == pytest.approx((1, 3))


def test_a_level_and_a_ring_are_marked():
    (axes,) = figure_of(plot(RISING, level=3.0, ring=2.0)).axes
    _, level, ring = axes.lines
    assert set(level.get_ydata()) == {3.0}
    assert np.linalg.norm(ring.get_xydata(), axis=1) == pytest.approx(2.0)


def test_axes_can_be_logarithmic_or_those_of_a_map():
    logarithmic, equal = figure_of(plot(RISING, logarithmic=True), plot(RISING, equal=True)).axes
    assert logarithmic.get_xscale() == "log"
    assert equal.get_aspect() == 1


def test_the_same_panels_give_the_same_bytes():
    one, other = (encode(Sheet((plot(RISING, FALLING),))) for _ in range(2))
    assert one == other
    assert one.startswith(b"\x89PNG")


ROWS = [AgeRow("sit", {"one": 6.0, "other": None}, (3.8, 5.9, 9.2)), AgeRow("rock", {"one": 5.5, "other": 7.0})]


def rows_axes():
    return draw(rows_sheet(ROWS, "real infants", ages_months=(0.0, 18.0))).axes[0]


def test_every_age_that_is_reached_has_a_mark_in_its_row():
    marks = {
        line.get_label(): list(zip(line.get_xdata(), map(round, line.get_ydata()), strict=True))
        for line in rows_axes().lines
        if line.get_label() in ("one", "other")
    }
    assert marks == {"one": [(6.0, 0), (5.5, 1)], "other": [(7.0, 1)]}


def test_usual_ages_are_bars_with_a_line_at_the_median_where_they_are_known():
    axes = rows_axes()
    (bar,) = axes.collections
    ages_months = bar.get_paths()[0].vertices[:, 0]
    assert (ages_months.min(), ages_months.max()) == (3.8, 9.2)
    assert [5.9, 5.9] in [list(line.get_xdata()) for line in axes.lines]


def test_rows_are_named_from_the_top():
    axes = rows_axes()
    assert [label.get_text() for label in axes.get_yticklabels()] == ["sit", "rock"]
    assert axes.get_ylim()[0] > axes.get_ylim()[1]
