"""The goals of the Makefile and the tasks of `.ci/task` do what they are asked to do."""

import os
import re
import subprocess
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[1]
GOALS = re.findall(r"^([a-z-]+):", (CHECKOUT / "Makefile").read_text(), re.MULTILINE)
TASKS = re.findall(r"^([a-z]+)\(\) ", (CHECKOUT / ".ci" / "task").read_text(), re.MULTILINE)
OF_MAKE = ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "TESTS")
"""Variables by which a `make` that runs this test would have its say."""


@pytest.mark.parametrize(("asked", "run"), [((), "tests"), (("TESTS=tests/runtime/device",), "tests/runtime/device")])
def test_make_test_runs_all_tests_or_the_part_that_is_named(asked, run):
    (tests,) = [line for line in recipes("test", *asked).splitlines() if line.strip().startswith('"tests: ')]
    assert tests.split()[-1] == f'{run}"'


def recipes(*asked: str) -> str:
    command = ["make", "--dry-run", "--always-make", *asked]
    env = {name: value for name, value in os.environ.items() if name not in OF_MAKE}
    return subprocess.run(command, cwd=CHECKOUT, env=env, capture_output=True, text=True, check=True, timeout=60).stdout


@pytest.mark.parametrize("goal", GOALS)
def test_the_shell_can_read_all_that_a_goal_runs(goal):
    """A comment sign in a variable of make once cut a recipe in the midst of a string."""
    read = subprocess.run(["sh", "-n"], input=recipes(goal), capture_output=True, text=True, timeout=60)
    assert (read.returncode, read.stderr) == (0, "")


def test_tasks_are_listed_with_what_they_do_and_others_refused():
    listed = subprocess.run([".ci/task"], cwd=CHECKOUT, capture_output=True, text=True, timeout=60, check=True)
    names = [line.split()[0] for line in listed.stdout.splitlines()]
    assert names == sorted(names)
    assert {*TASKS} == {*names, "needs"}
    refused = subprocess.run([".ci/task", "fuz"], cwd=CHECKOUT, capture_output=True, text=True, timeout=60, check=False)
    assert (refused.returncode, refused.stdout.splitlines()[0]) == (2, "'fuz' is not a task. The tasks are:")


def test_every_task_and_goal_that_a_page_names_exists():
    pages = [CHECKOUT / "README.md", CHECKOUT / "CONTRIBUTING.md", *(CHECKOUT / "docs").rglob("*.md")]
    text = "".join(page.read_text(encoding="utf-8") for page in pages)
    tasks = set(re.findall(r"\.ci/task ([a-z]+)", text))
    assert tasks
    assert tasks <= set(TASKS)
    assert set(re.findall(r"`make ([a-z-]+)`", text)) <= set(GOALS)
