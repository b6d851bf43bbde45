"""Which commands there are, and what their help says; its examples are run."""

import os
import re
import shlex
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import typer
from support.commands import Outcome
from support.full import FULL

import mimoc
from mimoc.cli import cohort, commands
from mimoc.motion.body_points import film
from mimoc.studies import growth as validation
from mimoc.studies.experiments import growth
from mimoc.training import settings
from mimoc.training.settings import HYPERPARAMETERS

CONFIGS = Path(__file__).parents[2] / "configs"
COMMANDS = {command.name or command.callback.__name__: command for command in commands.app.registered_commands}
COHORT_COMMANDS = {command.callback.__name__: command for command in cohort.app.registered_commands}


def test_the_commands_are_in_this_order():
    drawing, running = (
        ["explain", "report", "render", "see", "view", "rooms"],
        ["build", "validate", "run", "train", "evaluate", "skill", "movement", "bench", "experiment", "check"],
    )
    assert list(COMMANDS) == [
        "new",
        *running,
        *drawing,
        "retarget",
        "replay",
        "measure",
        "export",
        "import",
        "schema",
        "doctor",
    ]


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("option", ["--help", "-h"])
def test_the_help_of_each_command_has_an_example(invoke, command, option):
    done = invoke(command, option)
    assert (done.code, done.err) == (0, "")
    assert f"Example: mimoc {command} " in " ".join(done.out.split()) + " "


def without_notes(printed: str) -> list[str]:
    return [line for line in printed.splitlines() if not (line.startswith("note: ") or line.endswith(" left"))]


@FULL
@pytest.mark.slow
def test_the_examples_work_as_they_are_printed(invoke, here, monkeypatch):
    """Those that train, validate and experiment do less of it than elsewhere."""
    ppo = HYPERPARAMETERS["ppo"]
    brief = {"n_steps": replace(ppo["n_steps"], default=32), "n_epochs": replace(ppo["n_epochs"], default=1)}
    monkeypatch.setattr(settings, "HYPERPARAMETERS", {"ppo": ppo | brief})
    monkeypatch.setattr(validation, "MONTHS", (0, 12))
    monkeypatch.setattr(growth, "QUICK_MONTHS", (6,))
    (here / "config.yml").symlink_to(CONFIGS / "babybench.yml")
    for name in ("nine_months", "playroom", "reach"):
        assert invoke("new", f"{name}.yaml", "--like", name).code == 0
    model = mimoc.make("nine_months.yaml").unwrapped.model
    mimoc.write_points(film(model, model.key("supine").qpos[None].repeat(12, axis=0), 30.0), "keypoints.csv")
    for command in COMMANDS.values():
        program, *arguments = shlex.split(command.epilog.removeprefix("Example:"))
        done = invoke(*arguments)
        assert (program, done.code, without_notes(done.err)) == ("mimoc", 0, [])
    assert sorted(os.listdir()) == [
        "config.yml",
        "growth.png",
        "infant.html",
        "infant.schema.json",
        "keypoints.csv",
        "kim.yaml",
        "nine_months.html",
        "nine_months.png",
        "nine_months.yaml",
        "out",
        "playroom.yaml",
        "random.json",
        "reach.yaml",
        "recordings",
        "rooms.png",
        "runs",
        "seen.png",
        "self_touch.yaml",
    ]


def commands_below(group: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    """Yield all commands with what is typed for them, groups first."""
    yield path, group
    for name, command in getattr(group, "commands", {}).items():
        yield from commands_below(command, (*path, name))


@pytest.mark.parametrize(("path", "command"), [*commands_below(typer.main.get_command(commands.app))])
def test_help_shows_every_text_whole(invoke, path, command, monkeypatch):
    """Markdown takes only the marks of code away."""
    monkeypatch.setattr("typer.rich_utils.MAX_WIDTH", 2500)
    shown = "".join(invoke(*path, "--help").out.split())
    texts = [command.help, command.epilog, *(getattr(option, "help", None) for option in command.params)]
    texts += [option.metavar for option in command.params]
    texts += [other.help.partition("\n\n")[0] for other in getattr(command, "commands", {}).values()]
    for text in filter(None, texts):
        for line in re.split(r"\n\n|^- ", text.replace("`", ""), flags=re.MULTILINE):
            assert "".join(line.split()) in shown
            assert line.count("[") == line.count("]")
            assert line.count("(") == line.count(")")


@pytest.mark.parametrize("command", COHORT_COMMANDS)
def test_the_help_of_each_command_of_cohorts_has_an_example(invoke, command):
    done = invoke("cohort", command, "--help")
    assert (done.code, done.err) == (0, "")
    assert f"Example: mimoc cohort {command} spring.yaml " in " ".join(done.out.split())


def test_a_missing_example_says_how_to_write_it(invoke, here):
    """As the examples of the help name some, which no wheel puts where the user is."""
    done = invoke("build", "configs/nine_months.yaml", "-o", "out")
    advice = "the file does not exist; write this example with: mimoc new nine_months.yaml --like nine_months"
    assert (done.code, done.out, done.err) == (2, "", f"configs/nine_months.yaml:1:1: {advice}\n")
    assert invoke("new", "nine_months.yaml", "--like", "nine_months").code == 0
    assert invoke("build", "nine_months.yaml", "-o", "out").code == 0


def test_the_command_alone_is_help(invoke):
    done = invoke()
    assert "Start with" in done.out + done.err
    for command in COMMANDS:
        assert command in done.out + done.err


def test_the_version_is_printed(invoke):
    assert invoke("--version") == Outcome(0, f"mimoc {mimoc.__version__}\n", "")
