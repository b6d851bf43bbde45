"""What is committed is what `.ci/task viewer` builds from its source."""

from pathlib import Path
from subprocess import run

CHECKOUT = Path(__file__).parents[2]


def test_the_program_of_pages_is_built_from_its_source():
    """`make pages` has just built it."""
    done = run(
        ["git", "status", "--porcelain", "mimoc/viewer"], cwd=CHECKOUT, capture_output=True, text=True, check=True
    )
    assert done.stdout == ""
