"""The goals of the Makefile do what they are asked to do."""

import os
import subprocess
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[1]
OF_MAKE = ("MAKEFLAGS", "MFLAGS", "MAKELEVEL", "TESTS")
"""Variables by which a `make` that runs this test would have its say."""


@pytest.mark.parametrize(("asked", "run"), [((), "tests"), (("TESTS=tests/runtime/warp",), "tests/runtime/warp")])
def test_make_test_runs_all_tests_or_the_part_that_is_named(asked, run):
    command = ["make", "--dry-run", "--always-make", "test", *asked]
    env = {name: value for name, value in os.environ.items() if name not in OF_MAKE}
    done = subprocess.run(command, cwd=CHECKOUT, env=env, capture_output=True, text=True, check=True, timeout=60)
    (tests,) = [line for line in done.stdout.splitlines() if line.strip().startswith('"tests: ')]
    assert tests.split()[-1] == f'{run}"'
