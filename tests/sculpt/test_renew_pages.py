"""The pages of experiments have figures of the bodies that mimoc has, or say below their titles that they do not."""

import pytest
import renew_pages
from renew_pages import CHECKOUT, PAGES, Page, renew

OTHER = "0123456789abcdef"


@pytest.mark.full
@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.parent.name)
def test_the_figures_of_a_page_are_of_todays_bodies_or_it_says_so(path):
    assert not (problem := Page(path).problem), problem


@pytest.fixture
def copy(tmp_path, monkeypatch):
    monkeypatch.setattr(renew_pages, "CHECKOUT", tmp_path)

    def give(name: str) -> Page:
        page = Page(CHECKOUT / "docs" / "experiments" / name / f"{name}.md")
        path = tmp_path / name / f"{name}.md"
        path.parent.mkdir()
        path.write_text(page.text.replace(page.bodies, OTHER))
        return Page(path)

    return give


def test_a_page_of_other_bodies_is_told_in_one_line_with_what_to_do(copy):
    page = copy("inverse")
    assert page.problem == (
        f"inverse/inverse.md: of the bodies {OTHER}, today's are {page.todays}; "
        "run '.ci/task experiments', or mimoc experiment inverse -o inverse --development published"
    )


@pytest.mark.full
def test_the_page_of_a_long_experiment_says_that_its_bodies_are_earlier_ones_until_they_are_not(copy):
    page = copy("mobile")
    renew(page, long=False)
    marked = Page(page.path)
    assert marked.text.split("\n\n")[1].startswith("> **Of earlier bodies.**")
    assert f"`{OTHER}`" in marked.text.split("\n\n")[1]
    assert not marked.problem
    page.path.write_text(marked.text.replace(OTHER, page.todays))
    assert Page(page.path).problem
    renew(Page(page.path), long=False)
    assert page.path.read_text() == page.text.replace(OTHER, page.todays)


def test_a_short_experiment_is_run_again(copy, monkeypatch):
    page, runs = copy("inverse"), []
    monkeypatch.setattr(renew_pages, "run_experiment", lambda *what, **how: runs.append((*what, how)))
    renew(page, long=False)
    assert runs == [("inverse", page.path.parent, {"development": "published"})]
