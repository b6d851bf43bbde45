import sys

import numpy as np
import pytest

from mimoc.base.errors import MissingExtraError
from mimoc.base.quantities.outcome import LEARNING
from mimoc.render.plots.file import draw, encode
from mimoc.render.plots.plot import learning_sheet


def curve(rows, offset=0.0):
    """Return the columns of a learning curve."""
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
