"""The calls of a build stay in a folder, or come back to few others."""

from pathlib import Path

from support.folder_changes import folder_changes

import mimoc

SPEC = Path(__file__).parents[2] / "configs" / "nine_months.yaml"
MOST_CHANGES = 3000


def test_a_build_changes_folder_at_most_3000_times():
    spec = mimoc.load_spec(SPEC)
    mimoc.build(spec)  # What is imported or read from tables at first does not count.
    changes = folder_changes(lambda: mimoc.build(spec))
    assert 500 < changes.total() <= MOST_CHANGES, changes.most_common(10)
