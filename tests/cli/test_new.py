"""`mimoc new` writes specs to begin with, and `mimoc schema` what editors know of them."""

import json
import os
import pty
import re
from itertools import product
from pathlib import Path

import pytest
from support.commands import drained, process
from typer.main import get_command

import mimoc
from mimoc.cli.commands import app
from mimoc.schema import read_spec, source
from mimoc.schema.json_schema import json_schema, shipped_schema
from mimoc.schema.starter import Choices, new_spec, offered


def test_a_new_spec_is_the_one_that_was_chosen_and_tells_editors_of_its_schema(invoke, here):
    chosen = "--age 7.5 --hands five_finger --actuation muscle --senses touch,vision --scene crib --pose prone"
    code, out, err = invoke("new", "Kim's infant.yaml", *chosen.split())
    spec = mimoc.load_spec("Kim's infant.yaml")
    assert (code, err) == (0, "")
    assert out == """Kim's infant.yaml: build it with: mimoc build 'Kim'"'"'s infant.yaml' -o out/kim_s_infant\n"""
    assert (spec.name, spec.age_months, spec.body.hands) == ("kim_s_infant", 7.5, "five_finger")
    assert (spec.actuation.model, spec.scene.kind, spec.scene.pose) == ("muscle", "crib", "prone")
    assert {name for name, sense in spec.senses if sense} == {"touch", "vision"}
    assert spec.source.text.startswith(f"# yaml-language-server: $schema={shipped_schema()}\n")


def test_comments_can_be_turned_into_keys():
    lines = [re.sub("^( *)# ", r"\1", line) for line in new_spec(Choices()).splitlines()]
    spec = read_spec(source.parse("\n".join(lines), "x.yaml"))
    assert (spec.body.individual.sex, spec.delays.preset, spec.task.kind) == ("female", "physiological", "catch")
    assert {name for name, sense in spec.senses if sense} == {
        "proprioception",
        "vestibular",
        "touch",
        "vision",
        "hearing",
        "pain",
    }


@pytest.mark.parametrize(
    ("hands", "scene", "task"), [*product(("mitten", "five_finger"), ("flat", "room"), (None, "reach"))]
)
def test_any_choices_give_a_spec_that_says_them(hands, scene, task, here):
    choices = Choices(name="x", hands=hands, scene=scene, task=task, senses=())
    Path("x.yaml").write_text(new_spec(choices))
    spec = mimoc.load_spec("x.yaml")
    assert (spec.body.hands, spec.scene.kind, spec.task and spec.task.kind) == (hands, scene, task)


def test_a_spec_like_an_example_differs_from_it_in_its_name_only(invoke, here):
    assert invoke("new", "mine.yaml", "--like", "playroom").code == 0
    mine = mimoc.load_spec("mine.yaml")
    assert mine == mimoc.load_spec(Path(__file__).parents[2] / "configs" / "playroom.yaml").with_(name="mine")


@pytest.mark.parametrize(
    ("arguments", "problem"),
    {
        "--hands paws": "x.yaml:7:10: body.hands: 'paws' is not a choice; choose from five_finger, mitten",
        "--age 25": "x.yaml:4:13: age_months: 25",
        "--senses sight": "x.yaml:17:3: senses.sight: unknown key",
        "--impairment hemiparesis": "x.yaml:11:1: impairments.side: is missing",
        "--side left": "x.yaml:11:21: impairments.side: only the presets",
        "--like nobody": "'nobody' is not a name of an example; choose from all_senses",
        "--like catch --age 3": "'--like' takes an example as it is; give either that or choices",
    }.items(),
)
def test_a_wrong_choice_is_told_and_nothing_is_written(invoke, here, arguments, problem):
    code, out, err = invoke("new", "x.yaml", *arguments.split())
    assert (code, out, err[: len(problem)]) == (2, "", problem)
    assert os.listdir() == []


def answered(spec: str, *answers: str) -> tuple[int, str]:
    """Answer `mimoc new` in a terminal, accept whatever else is offered, and return the exit code and what is shown."""
    ours, theirs = pty.openpty()
    os.write(ours, "".join(f"{answer}\n" for answer in (*answers, *[""] * 6)).encode())
    with process("new", spec, stdin=theirs, stdout=theirs, stderr=theirs) as running:
        os.close(theirs)
        shown = drained(ours)
    os.close(ours)
    return running.returncode, shown.decode().replace("\r\n", "\n")


@pytest.mark.full
def test_a_terminal_is_asked_again_where_an_answer_is_wrong_and_keeps_the_others(here):
    wrong = ("99", "1e999", "old", "7.5", "paws", "five_finger", "", "sight", "touch, vision", "crib", "lying", "prone")
    code, shown = answered("kim.yaml", *wrong)
    spec = mimoc.load_spec("kim.yaml")
    assert code == 0
    assert (spec.age_months, spec.body.hands, spec.scene.kind, spec.scene.pose) == (7.5, "five_finger", "crib", "prone")
    assert {name for name, sense in spec.senses if sense} == {"touch", "vision"}
    errors = re.findall("Error: (.*)", shown)
    starts = [
        "age_months: 99 is too large; give 0 to 24 months",
        "1e999 is too large; write a smaller number",
        "age_months: 'old' is not a number",
        "body.hands: 'paws' is not a choice; choose from five_finger, mitten",
        "senses.sight: unknown key; choose from",
        "scene.pose: 'lying' is not a choice",
    ]
    assert [error[: len(start)] for error, start in zip(errors, starts, strict=True)] == starts, errors


@pytest.mark.full
def test_a_terminal_that_accepts_everything_gets_what_no_terminal_gets(invoke, here):
    assert answered("asked.yaml")[0] == 0
    assert invoke("new", "unasked.yaml").code == 0
    assert Path("asked.yaml").read_text().replace("asked", "") == Path("unasked.yaml").read_text().replace(
        "unasked", ""
    )


def test_an_existing_file_is_replaced_only_if_asked(invoke, here):
    Path("x.yaml").write_text("precious")
    assert invoke("new", "x.yaml").code == 2
    assert Path("x.yaml").read_text() == "precious"
    assert invoke("new", "x.yaml", "--force").code == 0
    assert mimoc.load_spec("x.yaml").age_months == 9


@pytest.mark.parametrize("option", ["hands", "actuation", "scene", "pose", "task", "impairment", "side"])
def test_the_help_of_a_choice_lists_what_the_schema_has(option):
    command = get_command(app).commands["new"]
    (found,) = (each for each in command.params if each.name == option)
    assert sorted(re.findall(r"\w+", found.help.replace(" or ", " "))) == sorted(offered()[option])


def test_a_spec_and_a_schema_can_be_piped(invoke, here):
    assert "age_months: 3" in invoke("new", "-", "--age", "3").out
    assert json.loads(invoke("schema").out) == json_schema()
    assert json.loads(invoke("schema", "cohort").out) == json_schema("cohort")
    assert os.listdir() == []
