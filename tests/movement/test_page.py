"""The page on measures of movement says what their records say."""

from pathlib import Path

from mimoc.base.quantities import QUANTITIES

PAGE = Path(__file__).resolve().parents[2] / "docs" / "movement_measures.md"


def test_the_page_has_each_measure_with_its_unit_definition_and_source():
    page = PAGE.read_text(encoding="utf-8")
    measures = [quantity for quantity in QUANTITIES.values() if quantity.over == "recording"]
    assert len(measures) >= 21
    for one in measures:
        row = f"| `{one.name}` | {one.label} | {one.unit or '-'} | {one.about} | {one.source or '-'} |"
        assert row in page
