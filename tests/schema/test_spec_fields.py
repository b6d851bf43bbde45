"""What holds of every field of the spec language."""

import csv
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from mimoc import schema
from mimoc.anatomy.parts import kinds_of_hands
from mimoc.base.errors import SpecError
from mimoc.components.senses.vision import AcuitySpec
from mimoc.schema import DelaysSpec, InfantSpec, SensesSpec, read_spec
from mimoc.schema.base import KeyPath
from mimoc.schema.kinds import SCENES, SENSES, TASKS
from mimoc.schema.names import MEASUREMENTS, limb_bodies, trunk_bodies
from mimoc.schema.outline import language_of
from mimoc.schema.source import parse

MODELS = [getattr(schema, name) for name in schema.__all__ if name.endswith("Spec")]
MODELS += [kind.spec for kinds in (SENSES, SCENES, TASKS) for kind in kinds.values() if kind.spec] + [AcuitySpec]
UNITS = "cm m kg deg ms px weeks months percentile percent cpd n s hz db thresholds cm2"
"""Endings of the names of keys."""
NO_UNIT = {"mimoc", "seed", "count", "density", "foveation", "length", "girth", "strength", "motor", "yoked_s"}
OF_AN_AGE = {"acuity", "contrast", "colour", "field", "focus", "vergence", "fovea", "flicker"}
"""Keys of which one kind of value has a unit, months."""
NO_UNIT |= OF_AN_AGE | {"thresholds"}
WRONG = [
    *("a word", "9 apples", "1.5", "-1", "1e300", "true", "[]", "[1]", "[a, a]", "[[1]]", "{}", "{x: 1}", "''", ".nan"),
    "",
]


def fields(path: KeyPath = ()) -> Iterator[tuple[KeyPath, dict[str, Any]]]:
    for key in language_of(InfantSpec).outline(path).keys:
        field = language_of(InfantSpec).outline((*path, key))
        yield (*path, key), field.schema
        yield from fields((*path, key))


FIELDS = dict(fields())


def test_every_section_and_field_is_documented():
    for model in MODELS:
        assert model.__doc__
        for name, field in model.model_fields.items():
            assert field.description, f"{model.__name__}.{name}"


def test_every_field_belongs_to_a_public_model():
    assert {name for model in MODELS for name in model.model_fields} == {str(path[-1]) for path in FIELDS} | {
        "length",
        "girth",
        "gain",
    }


def test_units_are_those_in_the_names():
    for path in FIELDS:
        unit = language_of(InfantSpec).outline(path).unit
        suffix = next((end for end in UNITS.split() if re.search(f"(^|_){end}$", path[-1])), None)
        if path[-1] not in NO_UNIT:
            assert unit == suffix, path
        elif path[-1] not in OF_AN_AGE:
            assert unit is None, path


def test_numbers_are_bounded_on_both_sides():
    for path, known in FIELDS.items():
        if known.get("type") in ("number", "integer") and "const" not in known:
            assert {"minimum", "exclusiveMinimum"} & known.keys(), path
            assert {"maximum", "exclusiveMaximum"} & known.keys(), path


@pytest.mark.parametrize("path", FIELDS, ids=".".join)
def test_any_wrong_value_gets_a_sentence_of_ours(path):
    head = "".join(f"{'  ' * depth}{key}:\n" for depth, key in enumerate(path))[:-1]
    for wrong in WRONG:
        try:
            read_spec(parse(f"{head} {wrong}\n", "f"))
        except SpecError as error:
            ours = [problem for problem in error.problems if problem.key.startswith(".".join(path))]
            for problem in ours:
                assert problem.line == len(path)
                assert re.fullmatch(r"[^;]+; [^;]+", problem.message), problem.message
                assert "Input" not in problem.message


def test_delays_are_known_for_every_sense():
    assert {f"{sense}_ms" for sense in SensesSpec.model_fields} == DelaysSpec.model_fields.keys() - {
        *("preset", "sensory_ms", "processing", "motor_ms")
    }


def test_measurements_are_those_of_the_tables():
    with (Path(__file__).parents[2] / "data" / "anthrokids.csv").open() as table:
        surveyed = {row["measurement"] for row in csv.DictReader(table)}
    assert set(MEASUREMENTS) == surveyed | {"middle_finger_diameter", "thumb_diameter"}


def test_hands_are_the_kinds_that_bodies_are_known_for():
    assert set(language_of(InfantSpec).outline(("body", "hands")).choices) == set(kinds_of_hands())
    assert len(trunk_bodies() + limb_bodies("mitten")) == 23
    assert len(trunk_bodies() + limb_bodies("five_finger")) == 55


def test_the_least_spec_needs_three_keys():
    assert language_of(InfantSpec).outline(()).schema["required"] == ["mimoc", "name", "age_months"]
    assert set(InfantSpec.model_fields) > {"mimoc", "name", "age_months"}


def test_an_added_part_of_nobody_is_refused_with_advice():
    with pytest.raises(SpecError, match="no script or plug-in has added any; register or install it first"):
        InfantSpec(mimoc=1, name="x", age_months=9, body={"extra": ["tail"]})
