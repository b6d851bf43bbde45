"""The JSON Schemas of specs and cohort files: they agree with mimoc wherever a schema can know."""

from pathlib import Path
from typing import Any

import jsonschema
import pytest
from hypothesis import given, settings
from support.any_specs import specs
from support.bad_specs import HEAD, SPECS

from mimoc.base.errors import SpecError
from mimoc.schema import InfantSpec, to_data
from mimoc.schema.json_schema import DIALECT, FILES, json_schema, json_text, shipped_schema
from mimoc.schema.source import parse

ROOT = Path(__file__).parents[2]
SPEC = jsonschema.Draft202012Validator(json_schema())
BEYOND_SCHEMAS = {  # Bad specs that a schema takes for good.
    *("repeated keys", "merge keys"),  # It sees what is left of them.
    "skin nowhere",
    # Keys against each other.
    *("two lengths", "a percentile of no sex", "an individual of whom nothing is known", "Toys4K from nowhere"),
    "delays of senses that are off",
    *("an act on a finger of a mitten", "skin points of parts on removed ones", "skin points of parts without skin"),
    *("groups that take commands and are locked", "fingers of a mitten"),
    *("standing up in a crib", "turning over in nothing", "turning over from sitting"),
    *("noise of a sense that is off", "noise in proportion to angles"),
    *("a caregiver in a crib", "an offer of nothing", "an offer of what is not there"),
    *("a look with a pitch", "acts out of order"),
    "an answer between physics steps",
    *("jitter of no delay", "jitter of delays of senses that are off", "jitter between physics steps"),
    *("delays between physics steps", "a control step between physics steps"),
    *("a control step shorter than physics", "a physics step that does not fit"),
}


def data_of(content: str | bytes) -> Any:
    try:
        return parse(content if isinstance(content, str) else content.decode(), "spec.yaml").data
    except (SpecError, UnicodeDecodeError):
        return None


def test_specs_that_mimoc_refuses_are_refused_by_the_schema_unless_keys_contradict_each_other():
    read = {case: data_of(content) for case, content in SPECS.items()}
    accepted = {case for case, data in read.items() if data is not None and SPEC.is_valid(data)}
    assert accepted == BEYOND_SCHEMAS


@settings(max_examples=40)
@given(specs())
def test_specs_that_mimoc_accepts_are_accepted_by_the_schema(spec):
    SPEC.validate(to_data(spec))


@pytest.mark.parametrize("path", sorted((ROOT / "configs").glob("*.yaml")), ids=lambda path: path.stem)
def test_the_configs_are_accepted(path):
    SPEC.validate(data_of(path.read_text()))


def test_the_cohort_in_the_examples_is_accepted_and_one_that_does_nothing_is_not():
    cohort = jsonschema.Draft202012Validator(json_schema("cohort"))
    data = data_of((ROOT / "examples" / "cohort" / "spring.yaml").read_text())
    cohort.validate(data)
    assert not cohort.is_valid({**data, "do": ["nothing"]})
    assert not cohort.is_valid({key: value for key, value in data.items() if key != "do"})


@pytest.mark.parametrize("of", FILES)
def test_schemas_follow_their_dialect_and_are_those_that_come_with_mimoc(of):
    schema = json_schema(of)
    jsonschema.Draft202012Validator.check_schema(schema)
    assert schema["$schema"] == DIALECT
    assert shipped_schema(of).read_text() == json_text(schema)


@pytest.mark.parametrize("key", InfantSpec.model_fields)
def test_every_key_is_explained_in_one_paragraph(key):
    assert "\n" not in SPEC.schema["properties"][key]["description"].replace("\n\n", "")


def test_keys_without_a_value_are_refused_as_mimoc_does():
    assert not SPEC.is_valid(data_of(HEAD + "task:\n"))
