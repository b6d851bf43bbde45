from mimoc.render.plots.file import draw
from mimoc.studies.growth.plot import AgeRow, rows_sheet

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
