"""The references of the documentation leave nothing out: keys of specs, commands with their options, public names."""

import re
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from types import ModuleType

import pytest

import mimoc
from mimoc.schema.infant import InfantSpec
from mimoc.schema.outline import language_of

DOCS = Path(__file__).resolve().parents[1] / "docs"
COMMANDS = "build", "check", "explain", "run", "train", "validate", "cohort run", "cohort table"


@pytest.fixture
def extension(monkeypatch) -> Callable[[str], ModuleType]:
    monkeypatch.setattr(sys, "path", [str(DOCS / "_ext"), *sys.path])
    return import_module


def test_the_reference_of_specs_has_every_key_once_in_its_section(extension):
    text = extension("spec_reference").reference("spec")
    language = language_of(InfantSpec)
    sections = dict(re.findall(r"^##+ `([\w.]+)`\n(.*?)(?=^##|\Z)", text, re.MULTILINE | re.DOTALL))
    assert {"body", "senses.touch", "delays", "scene.toys"} <= sections.keys()
    for name, section in sections.items():
        path = tuple(name.split("."))
        if not language.kinds_of(path):
            assert re.findall(r"^`(\w+)`$", section, re.MULTILINE) == list(language.outline(path).keys), name
    assert {f"task: {{kind: {kind}}}" for kind in language.kinds_of(("task",))} <= set(re.findall("`(.*?)`", text))


def test_the_reference_of_specs_says_what_values_there_are_with_their_units_and_defaults(extension):
    text = extension("spec_reference").reference("spec")
    assert "`age_months`\n: *number, at least 0, at most 24, in months; required*" in text
    assert "`hands`\n: *`mitten` or `five_finger`; default `mitten`*" in text
    assert "`motor`\n: *`maturing` or number, at least 0, at most 1; default `0.0`*" in text


@pytest.mark.parametrize("command", COMMANDS)
def test_the_reference_of_commands_has_the_options_that_help_shows(extension, invoke, monkeypatch, command):
    monkeypatch.setenv("COLUMNS", "200")
    text = extension("cli_reference").reference()
    section = re.search(rf"^##+ `mimoc {command}`\n(.*?)(?=^##|\Z)", text, re.MULTILINE | re.DOTALL)[1]
    entries = " ".join(re.findall(r"^`(.*)`$", section, re.MULTILINE))
    shown = " ".join(re.findall(r"^│[ *]+((?:--[\w-]+ +)+)", invoke(*command.split(), "--help").out, re.MULTILINE))
    assert set(shown.split()) - {"--help"} == set(re.findall(r"--[\w-]+", entries))


def test_the_reference_of_python_has_every_public_name_once():
    text = (DOCS / "api.md").read_text(encoding="utf-8")
    named = re.findall(r"^\.\. auto\w+:: (\w+)$", text, re.MULTILINE)
    assert sorted(named) == sorted(set(mimoc.__all__) - {"__version__"})
