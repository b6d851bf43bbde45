"""The command that writes pages."""

import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from support.pages import few_ages, read_page

import mimoc
from mimoc.bundle.io import lock_files


@pytest.fixture(scope="module", autouse=True)
def pages_of_few_ages() -> Iterator[None]:
    with few_ages():
        yield


def test_it_writes_a_page_and_says_where(invoke, here, built):
    assert invoke("view", built, "-o", "infant.html") == (0, "infant.html\n", "")
    assert read_page(Path("infant.html").read_text())["name"] == "nine_months"


def test_it_opens_the_browser_when_asked(invoke, here, built, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    assert invoke("view", built, "-o", "infant.html", "--open").code == 0
    assert opened == [(here / "infant.html").as_uri()]


@pytest.mark.parametrize(("flags", "expected"), [([], 1), (["--no-open"], 0)])
def test_in_a_terminal_with_a_display_it_opens_the_browser_unless_told_not_to(
    flags, expected, invoke, here, built, monkeypatch
):
    opened = []
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr("mimoc.cli.pages._in_a_terminal", lambda: True)
    monkeypatch.setenv("DISPLAY", ":0")
    assert invoke("view", built, "-o", "infant.html", *flags).code == 0
    assert len(opened) == expected


def test_the_page_of_a_recording_replays_it(invoke, here, built):
    assert invoke("run", built, "--steps", 5, "--record", "recordings/short").code == 0
    assert invoke("view", "recordings/short", "-o", "page.html") == (0, "page.html\n", "")
    assert len(read_page(Path("page.html").read_text())["recording"]["seconds"]) == 6


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["-o", "page.png"], "page.png: not the name of a page; end it in .html or .htm"),
        ([], "say where to write the page with -o FILE.html, or serve a running infant with --live"),
        (["-o", "page.html", "--episode", 2], "{built}: this is no recording; --infant and --episode choose from one"),
        (
            ["-o", "none/page.html"],
            "none/page.html: there is no folder none; make it, or choose another place",
        ),
    ],
)
def test_bad_input_is_one_line_and_exit_code_2(arguments, message, invoke, here, built):
    code, out, err = invoke("view", built, *arguments)
    assert (code, out, err) == (2, "", message.format(built=built) + "\n")
    assert not list(here.rglob("*.*"))


def test_serving_without_viser_says_what_to_install(invoke, here, built, monkeypatch):
    monkeypatch.setitem(sys.modules, "viser", None)
    code, _, err = invoke("view", built, "--live")
    assert (code, err) == (2, "viser is not installed; run: pip install 'mimoc[live]'\n")


def test_an_infant_that_a_page_cannot_show_at_all_ages_is_refused_in_one_line(invoke, here, built):
    bundle = mimoc.read_bundle(built)
    files = {name: content for name, content in bundle.files.items() if name not in ("resolved.yaml", "lock.json")}
    mimoc.write_bundle(lock_files(files, {}, {}), here / "without_spec")
    code, _, err = invoke("view", here / "without_spec", "-o", "page.html")
    assert (code, err) == (2, "there is no resolved.yaml in it\n")
