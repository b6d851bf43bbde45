"""Every program of the gallery runs, is short, and draws a picture."""

import runpy
from pathlib import Path

import matplotlib.pyplot as plt
import pytest
from support.full import full_but

GALLERY = Path(__file__).parents[2] / "examples" / "gallery"
PROGRAMS = sorted(GALLERY.glob("plot_*.py"))
LONG = ("plot_vision", "plot_percentiles", "plot_strength", "plot_cohort")
QUICK = [program for program in PROGRAMS if program.stem not in LONG]


@pytest.fixture
def shown(monkeypatch) -> list[int]:
    """Return the numbers of figures that are shown, which no window does."""
    numbers: list[int] = []
    monkeypatch.setattr(plt, "show", lambda: numbers.extend(plt.get_fignums()))
    plt.switch_backend("agg")
    yield numbers
    plt.close("all")


@pytest.mark.parametrize("program", full_but(QUICK, PROGRAMS), ids=lambda program: program.stem)
def test_a_program_of_the_gallery_draws_a_picture(program, shown, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    runpy.run_path(str(program), run_name="__main__")
    assert shown
    assert not list(tmp_path.iterdir())


def test_programs_of_the_gallery_are_short():
    assert len(PROGRAMS) >= 10
    assert max(len(program.read_text(encoding="utf-8").splitlines()) for program in PROGRAMS) < 60
