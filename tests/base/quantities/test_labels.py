"""A label and a unit have one home: the record of a quantity."""

import ast
import re
from pathlib import Path

import mimoc
from mimoc.base.quantities import QUANTITIES, measures, quantity_of
from mimoc.training.curve import CurvePoint

ROOT = Path(mimoc.__file__).parent
READERS = sorted(path for folder in ("reporting", "cohorts", "cli") for path in (ROOT / folder).rglob("*.py"))
UNIT = re.compile(r"[A-Za-z] \[(?!build|default)[^\[\]{}`'|]{1,16}\]")
SUFFIXES = {"cm": "cm", "kg": "kg", "s": "s", "m": "m", "rad/s": "rad_s", "J/kg": "j_per_kg", "°": "deg"}


def texts(path: Path) -> list[str]:
    """Return the strings of a module but for docstrings."""
    tree = ast.parse(path.read_text())
    docs = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    return [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docs
    ]


def test_no_reader_of_quantities_has_a_unit_in_brackets():
    assert [(path.name, text) for path in READERS for text in texts(path) if UNIT.search(text)] == []


def test_the_pattern_finds_units():
    assert all(map(UNIT.search, ("Length [cm]", "speed [rad/s]", "share [%]", "Beyond [°]", "Steps [control steps]")))


def test_the_name_of_a_quantity_ends_with_its_unit():
    for quantity in QUANTITIES.values():
        if quantity.unit in SUFFIXES:
            assert quantity.name.endswith(f"_{SUFFIXES[quantity.unit]}"), quantity.name


def test_every_quantity_says_what_it_is():
    assert all(quantity.about and quantity.label[0].isupper() for quantity in QUANTITIES.values())


def test_every_measure_of_a_run_has_at_most_one_way_to_be_measured():
    for quantity in measures().values():
        assert sum(map(bool, (quantity.term, quantity.read, quantity.field))) <= 1, quantity.name


def test_columns_of_learning_curves_are_those_of_rows():
    fields = set(CurvePoint.__dataclass_fields__)
    assert {quantity.curve for quantity in QUANTITIES.values() if quantity.curve} == fields - {"wall_s"}


def test_what_is_no_quantity_is_called_by_its_name():
    assert quantity_of("joint_speed_rad_s").title == "Joint speed [rad/s]"
    assert quantity_of("what_the_policy_says").title == "What the policy says"
