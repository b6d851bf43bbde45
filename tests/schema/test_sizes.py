"""No size of a body has two values, whichever two keys of the language name it; one side counts in place of both."""

import re
from itertools import combinations
from typing import Any

import pytest

import mimoc
from mimoc.base.errors import SpecError
from mimoc.compiler.manifest import notes
from mimoc.compiler.toys import Toybox
from mimoc.fits import load_tables, measure
from mimoc.schema import InfantSpec, read_spec
from mimoc.schema.outline import language_of
from mimoc.schema.source import dump, parse
from mimoc.studies.growth import grow_against_who

BODY = language_of(InfantSpec)
HEAD = {"mimoc": 1, "name": "x", "age_months": 9}
SIZES = {"length": "crown_sole_length", "head": "head_circumference", "weight": "weight"}
"""What the keys of an individual are of, by their first word."""
NO_SIZES = {"sex", "fat_percentile", "fat_percent", "maturation_rate"}

Key = tuple[str, ...]


def keys() -> list[Key]:
    """Return every key of the language that says how large a body is, or a part of it."""
    individual = [("individual", key) for key in BODY.outline(("body", "individual")).keys if key not in NO_SIZES]
    names = BODY.outline(("body", "measurements")).schema["propertyNames"]["enum"]
    return [*individual, *(("measurements", name) for name in names)]


def sizes(key: Key) -> set[str]:
    """Return the sizes that a key is of, from its words alone; those of limbs have a side."""
    section, name = key
    if section == "individual":
        return {SIZES[name.partition("_")[0]]}
    size = name.removesuffix("_cm")
    sided = {f"{side}_{size}" for side in ("left", "right") if ("measurements", f"{side}_{size}_cm") in ALL}
    return sided or {size}


ALL = set(keys())


MEDIANS = {"crown_sole_length": "length_cm", "head_circumference": "head_circumference_cm", "weight": "weight_kg"}


def value(key: Key) -> float:
    """Return what a girl on WHO's medians has of a size, or else the average child."""
    if "percentile" in key[1]:
        return 50.0
    size = next(iter(sizes(key))).removeprefix("left_").removeprefix("right_")
    if size in MEDIANS:
        return round(load_tables().who[MEDIANS[size]].value(0, 9, "female"), 1)
    return round(100 * measure(9)[size], 1)


def body(*said: tuple[Key, float]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for (section, name), size in said:
        found.setdefault(section, {})[name] = size
    if "individual" in found:
        found["individual"]["sex"] = "female"
    return found


PAIRS = [(first, second) for first, second in combinations(keys(), 2) if sizes(first) & sizes(second)]
SIDED = [(first, second) for first, second in PAIRS if sizes(first) != sizes(second)]


def test_there_are_pairs_of_every_two_sections():
    sections = {tuple(sorted(key[0] for key in pair)) for pair in PAIRS}
    assert sections == {("individual", "individual"), ("individual", "measurements"), ("measurements", "measurements")}
    assert len(SIDED) > 20


def contradicting(pair: tuple[Key, Key]) -> dict[str, Any]:
    first, second = pair
    return body((first, value(first)), (second, value(second) * 1.05))


def test_two_values_of_one_size_are_one_line_with_both_places():
    for pair in set(PAIRS) - set(SIDED):
        text = dump({**HEAD, "body": contradicting(pair)})
        with pytest.raises(SpecError) as refused:
            read_spec(parse(text, "spec.yaml"))
        (problem,) = refused.value.problems
        dotted = ["body." + ".".join(key) for key in pair]
        assert problem.key in dotted, pair
        (other,) = set(dotted) - {problem.key}
        (line,) = re.findall(f"'{re.escape(other)}' in line ([0-9]+)", problem.message)
        for number, key in ((problem.line, problem.key), (int(line), other)):
            assert key.rpartition(".")[2] in text.splitlines()[number - 1], (pair, text)
        assert problem.message.endswith("leave one of the two out")


def test_one_side_counts_in_place_of_both_and_is_noted():
    for both, side in SIDED:
        (note,) = notes_on(contradicting((both, side)))
        assert note == f"'body.{'.'.join(side)}' counts in place of 'body.{'.'.join(both)}' on that side"


def notes_on(said: dict[str, Any]) -> tuple[str, ...]:
    spec = InfantSpec.model_validate({**HEAD, "body": said})
    return notes(spec, Toybox((), lambda name: pytest.fail(name)), {})


def test_the_same_value_twice_is_noted():
    for pair in PAIRS:
        (note,) = notes_on(body(*((key, value(key)) for key in pair)))
        assert note.endswith("say the same; one of the two is enough")
        assert all(f"'body.{'.'.join(key)}'" in note for key in pair)


def test_keys_of_different_sizes_do_not_contradict():
    taken, said = set[str](), []
    for key in reversed(keys()):
        if not sizes(key) & taken:
            taken |= sizes(key)
            said.append((key, value(key)))
    assert len(said) > 40
    InfantSpec.model_validate({**HEAD, "body": body(*said)})


def test_a_factor_is_on_what_a_part_would_be_otherwise():
    said = {"measurements": {"head_circumference_cm": 44}, "parts": {"head": {"girth": 1.1}}}
    report = grow_against_who(InfantSpec.model_validate({**HEAD, "body": said}), (9,))
    (head,) = report.by_indicator["head_circumference_cm"]
    assert head.value == pytest.approx(1.1 * 44, rel=0.01)
    assert not head.is_judged


def test_of_a_percentile_and_the_measure_on_its_chart_the_measure_is_built():
    """A girl's median length at 9 months is 70.1435 cm; charts print 70.1."""
    individual = {"sex": "female", "length_percentile": 50, "length_cm": 70.1}
    bundle = mimoc.build(InfantSpec.model_validate({**HEAD, "body": {"individual": individual}}))
    assert bundle.manifest.child.length_cm == pytest.approx(70.1, abs=1e-4)
    assert (
        "'body.individual.length_percentile' and 'body.individual.length_cm' say the same" in bundle.manifest.notes[0]
    )
