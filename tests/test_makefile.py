"""The goals of the Makefile do what they are asked to do."""

import os
import re
import subprocess
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[1]
GOALS = re.findall(r"^([a-z-]+):", (CHECKOUT / "Makefile").read_text(), re.MULTILINE)
OF_MAKE = ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "TESTS")
"""Variables by which a `make` that runs this test would have its say."""


@pytest.mark.parametrize(("asked", "run"), [((), "tests"), (("TESTS=tests/runtime/device",), "tests/runtime/device")])
def test_make_test_runs_all_tests_or_the_part_that_is_named(asked, run):
    (tests,) = [line for line in recipes("test", *asked).splitlines() if line.strip().startswith('"tests: ')]
    assert tests.split()[-1] == f'{run}"'


def recipes(*asked: str) -> str:
    """Return what `make` would have the shell run."""
    command = ["make", "--dry-run", "--always-make", *asked]
    env = {name: value for name, value in os.environ.items() if name not in OF_MAKE}
    return subprocess.run(command, cwd=CHECKOUT, env=env, capture_output=True, text=True, check=True, timeout=60).stdout


@pytest.mark.parametrize("goal", GOALS)
def test_the_shell_can_read_all_that_a_goal_runs(goal):
    """A comment sign in a variable of make once cut a recipe in the midst of a string."""
    read = subprocess.run(["sh", "-n"], input=recipes(goal), capture_output=True, text=True, timeout=60)
    assert (read.returncode, read.stderr) == (0, "")
