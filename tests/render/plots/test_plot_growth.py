import subprocess
import sys
from pathlib import Path

import pytest
from PIL import Image

from mimoc.base.errors import MissingExtraError, OutputError
from mimoc.base.quantities.child import INDICATORS
from mimoc.render.plots import file
from mimoc.render.plots.file import draw, write_sheet
from mimoc.studies.growth_plots import growth_sheet, measurements_sheet

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
    monkeypatch.setattr(file, "draw", lambda sheet: figure)


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
    imports = "from mimoc.render.plots import file; from mimoc.studies import growth_plots as growth"
    code = f"import sys; {imports}; file.write_sheet(growth.growth_sheet({{}}), sys.argv[1]); print(*sys.modules)"
    modules = subprocess.run(
        [sys.executable, "-c", code, str(tmp_path / "growth.png")], capture_output=True, text=True, check=True
    ).stdout.split()
    assert "matplotlib.figure" in modules
    assert "matplotlib.pyplot" not in modules
