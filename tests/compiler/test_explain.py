import pytest

from mimoc.base.errors import MimocError
from mimoc.compiler.explain import Explanation, entries_of, explain


@pytest.fixture(scope="module")
def bundle(bundle_at):
    return bundle_at(9)


@pytest.fixture(scope="module")
def entries(bundle):
    return entries_of(bundle)


def all_of(explanation: Explanation) -> list[Explanation]:
    return [explanation, *(deeper for source in explanation.sources for deeper in all_of(source))]


def test_every_number_can_be_explained(bundle, entries):
    for key in entries:
        explanation = explain(bundle, key)
        assert explanation.key == key
        assert all(explanation.lines)


def test_a_foots_mass_leads_back_to_table_rows_and_the_age(bundle):
    told = all_of(explain(bundle, "body.left_foot.mass"))
    keys = [explanation.key for explanation in told]
    assert keys[:3] == ["body.left_foot.mass", "geom.left_foot1.mass", "geom.left_foot1.size"]
    assert {"measurements.foot_length_cm", "measurements.foot_breadth_cm", "spec.age_months"} <= set(keys)
    text = "\n".join(line for explanation in told for line in explanation.lines)
    assert "anthrokids.csv: foot_length, log fit" in text
    assert "fit: a = " in text
    assert "inferred birth row" in text
    assert "MIMo's reference body" in text


def test_an_explanation_starts_with_value_and_unit(bundle, entries):
    first, *_ = explain(bundle, "body.left_foot.mass").lines
    assert first == f"{entries['body.left_foot.mass']['value']:.6g} kg"


def test_an_explanation_says_which_attribute_has_the_number(bundle):
    *_, last = explain(bundle, "actuator.act:left_elbow.gear").lines
    assert last == "written to infant.xml: general[@name='act:left_elbow']/@gear"


def test_vectors_are_told_number_by_number(bundle, entries):
    first, *_ = explain(bundle, "geom.lb.size").lines
    assert first == " ".join(f"{size:.6g}" for size in entries["geom.lb.size"]["value"]) + " m"


WRONG_KEYS = {
    "body.left_fot.mass": "'body.left_fot.mass' is not a number of this bundle; did you mean 'body.left_foot.mass'",
    "actuator.act:left_elbw.gear": "did you mean 'actuator.act:left_elbow.gear'",
    "measurements.head_circumference": "did you mean 'measurements.head_circumference_cm'",
    "xyzzy": "without one, `mimoc explain` lists them all",
    "": "without one, `mimoc explain` lists them all",
}


@pytest.mark.parametrize("key", WRONG_KEYS)
def test_a_wrong_key_gets_near_names(bundle, key):
    with pytest.raises(MimocError) as refusal:
        explain(bundle, key)
    assert WRONG_KEYS[key] in str(refusal.value)


def test_a_wrong_key_gets_only_keys_that_exist(bundle, entries):
    with pytest.raises(MimocError) as refusal:
        explain(bundle, "spec.age")
    named = str(refusal.value).split("did you mean ")[1].rstrip("?").replace("'", "").split(" or ")
    assert all(any(part in key for key in entries) for part in named)
