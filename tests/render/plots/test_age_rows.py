from mimoc.render.plots.age_rows import AgeRow, draw_age_rows

ROWS = [AgeRow("sit", {"one": 6.0, "other": None}, (3.8, 9.2)), AgeRow("rock", {"one": 5.5, "other": 7.0})]


def test_every_age_that_is_reached_has_a_mark_in_its_row():
    axes = draw_age_rows(ROWS, 18, "real infants").axes[0]
    marks = {
        line.get_label(): list(zip(line.get_xdata(), map(round, line.get_ydata()), strict=True)) for line in axes.lines
    }
    assert marks == {"one": [(6.0, 0), (5.5, 1)], "other": [(7.0, 1)]}


def test_usual_ages_are_bars_where_they_are_known():
    (bar,) = draw_age_rows(ROWS, 18, "real infants").axes[0].patches
    assert (bar.get_x(), bar.get_width()) == (3.8, 9.2 - 3.8)


def test_rows_are_named_from_the_top():
    axes = draw_age_rows(ROWS, 18, "").axes[0]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["sit", "rock"]
    assert axes.get_ylim()[0] > axes.get_ylim()[1]
