"""The page on reflexes says of each what its record says."""

from pathlib import Path

import pytest

from mimoc.policies.reflexes.binding import REFLEXES

PAGE = Path(__file__).parents[3] / "docs" / "reflexes.md"


def row(reflex) -> str:
    onset, loss = reflex.ages.onset_months, reflex.ages.loss_months
    since = "birth" if onset is None else f"{onset[0]:g} to {onset[1]:g}"
    until = "stays" if loss is None else f"{loss[0]:g} to {loss[1]:g}"
    senses = ", ".join(reflex.senses)
    return (
        f"| `{reflex.name}` | {reflex.stimulus} | {reflex.response} | {since} | {until} | {senses} | {reflex.source} |"
    )


@pytest.mark.parametrize("name", REFLEXES)
def test_the_page_has_the_row_of_each_reflex(name):
    assert row(REFLEXES[name]) in PAGE.read_text(encoding="utf-8").splitlines()


def test_the_page_has_no_other_reflex():
    rows = [line for line in PAGE.read_text(encoding="utf-8").splitlines() if line.startswith("| `")]
    assert len(rows) == len(REFLEXES)
