"""Commands, programs and links that the pages in docs print; README and `own_scene.md` have tests of their own."""

import re
import shlex
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[1]


def blocks(page: str, language: str) -> list[str]:
    """Return the blocks of a language on a page."""
    text = (CHECKOUT / page).read_text(encoding="utf-8")
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    """Return a working directory with the configs of the checkout."""
    (tmp_path / "configs").symlink_to(CHECKOUT / "configs")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def test_the_commands_for_code_written_for_mimo_work(here, invoke):
    commands = "".join(blocks("docs/compatibility.md", "sh")).splitlines()
    assert commands
    for command in commands:
        program, *arguments = shlex.split(command, comments=True)
        assert program == "mimoc"
        assert invoke(*arguments)[0] == 0, command
    assert (here / "out" / "for_mimo" / "scene.xml").exists()


def test_the_program_that_runs_an_experiment_works(here):
    """The quickest experiment stands in for the one that is printed."""
    (program,) = blocks("docs/experiments/README.md", "python")
    assert '"strength"' in program
    exec(program.replace("strength", "growth"), {})
    assert any((here / "out" / "growth").glob("*.md"))


@pytest.mark.slow
def test_the_programs_that_run_many_infants_work(here, capsys):
    session: dict = {}
    for program in blocks("docs/many.md", "python"):
        exec(program, session)
    assert capsys.readouterr().out.startswith("(8, ")


def test_the_programs_on_growing_work(here):
    session: dict[str, object] = {}
    for program in blocks("docs/growing.md", "python"):
        exec(program, session)
    assert session["schedule"](0) == 6


def test_every_file_that_a_page_links_to_exists():
    pages = [CHECKOUT / "README.md", CHECKOUT / "CONTRIBUTING.md", *(CHECKOUT / "docs").rglob("*.md")]
    pages += (CHECKOUT / "examples").rglob("*.md")
    links = [
        (page, link) for page in pages for link in re.findall(r"\]\(([^)#:]+)\)", page.read_text(encoding="utf-8"))
    ]
    assert len(links) > 20
    assert [(page.name, link) for page, link in links if not (page.parent / link).exists()] == []


def test_every_module_that_contributing_names_exists():
    named = re.findall(r"`(mimoc/[a-z0-9_/]+(?:\.py|/))`", (CHECKOUT / "CONTRIBUTING.md").read_text(encoding="utf-8"))
    assert len(named) > 20
    assert [name for name in named if not (CHECKOUT / name).exists()] == []
