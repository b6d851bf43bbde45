"""No size of a body has two values, whichever two keys of the language name it."""

import re
from itertools import combinations
from typing import Any

import pytest

import mimoc
from mimoc.compiler.notes import notes
from mimoc.errors import SpecError
from mimoc.fits import load_tables, measure
from mimoc.schema import InfantSpec, read_spec
from mimoc.schema.names import KINDS_OF_HANDS, limb_bodies, trunk_bodies
from mimoc.schema.outline import language_of
from mimoc.schema.sizes import PART_SIZES, namings
from mimoc.schema.source import parse
from mimoc.schema.yaml_scalars import dump
from mimoc.toys.choosing import Toybox

BODY = language_of(InfantSpec)
HEAD = {"mimoc": 1, "name": "x", "age_months": 9}
SIZES = {"length": "crown_sole_length", "head": "head_circumference", "weight": "weight"}
"""What the keys of an individual are of, by their first word."""

Key = tuple[str, ...]


def keys() -> list[Key]:
    """Return every key of the language that says how large a body is, or a part of it."""
    individual = [("individual", key) for key in BODY.outline(("body", "individual")).keys if key != "sex"]
    names = BODY.outline(("body", "measurements")).schema["propertyNames"]["enum"]
    parts = BODY.outline(("body", "parts")).schema["propertyNames"]["enum"]
    factors = BODY.outline(("body", "parts", parts[0])).keys
    measurements = [("measurements", name) for name in names]
    return [*individual, *measurements, *(("parts", part, factor) for part in parts for factor in factors)]


def sizes(key: Key) -> set[str]:
    """Return the sizes that a key is of, from its words alone; those of limbs have a side."""
    section, name = key[:2]
    if section == "individual":
        return {SIZES[name.partition("_")[0]]}
    if section == "parts":
        side = next((side for side in ("left", "right") if name.startswith(f"{side}_")), "")
        part = name.removeprefix(f"{side}_")
        named = PART_SIZES.get(part, {}).get(key[2], ())
        return {f"{side}_{size}" if ("measurements", f"{side}_{size}_cm") in ALL else size for size in named}
    size = name.removesuffix("_cm")
    sided = {f"{side}_{size}" for side in ("left", "right") if ("measurements", f"{side}_{size}_cm") in ALL}
    return sided or {size}


ALL = set(keys())


MEDIANS = {"crown_sole_length": "length_cm", "head_circumference": "head_circumference_cm", "weight": "weight_kg"}


def value(key: Key) -> float:
    """Return what a girl on WHO's medians has of a size, or else the average child; or a factor."""
    if key[0] == "parts":
        return 1.1
    if "percentile" in key[1]:
        return 50.0
    size = next(iter(sizes(key))).removeprefix("left_").removeprefix("right_")
    if size in MEDIANS:
        return round(load_tables().who[MEDIANS[size]].value(0, 9, "female"), 1)
    return round(100 * measure(9)[size], 1)


def body(*said: tuple[Key, float]) -> dict[str, Any]:
    """Return a body with some keys, with hands that have the parts they name."""
    hands = [
        hands for hands in KINDS_OF_HANDS if all(key[1] in parts_of(hands) for key, _ in said if key[0] == "parts")
    ]
    found: dict[str, Any] = {"hands": hands[0]}
    for key, size in said:
        section = found
        for step in key[:-1]:
            section = section.setdefault(step, {})
        section[key[-1]] = size
    if "individual" in found:
        found["individual"]["sex"] = "female"
    return found


def parts_of(hands: str) -> tuple[str, ...]:
    return trunk_bodies() + limb_bodies(hands)


PAIRS = [
    pair
    for pair in combinations(keys(), 2)
    if sizes(pair[0]) & sizes(pair[1]) and {key[0] for key in pair} != {"parts"}
]


def test_there_are_pairs_of_every_two_sections():
    sections = {tuple(sorted(key[0] for key in pair)) for pair in PAIRS}
    every = {"individual", "measurements", "parts"}
    assert sections == {tuple(sorted(two)) for two in combinations(every, 2)} | {
        (one, one) for one in every - {"parts"}
    }
    assert len(PAIRS) > 100


def contradicting(pair: tuple[Key, Key]) -> dict[str, Any]:
    """Return a body in which two keys have different values."""
    first, second = pair
    return body((first, value(first)), (second, value(second) * (1 if second[0] == "parts" else 1.05)))


def test_two_values_of_one_size_are_one_line_with_both_places():
    """All pairs of keys of one size that the language has, told by their words."""
    for pair in PAIRS:
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
        assert problem.message.endswith(("leave one of the two out", "give left_ and right_ instead of both sides"))


def test_the_same_value_twice_is_noted():
    """A percentile and a measure are the same if they agree on WHO's charts."""
    for pair in PAIRS:
        if "parts" not in (pair[0][0], pair[1][0]):
            spec = InfantSpec.model_validate({**HEAD, "body": body(*((key, value(key)) for key in pair))})
            (note,) = notes(spec, Toybox((), lambda name: pytest.fail(name)), {})
            assert note.endswith("say the same; one of the two is enough")
            assert all(f"'body.{'.'.join(key)}'" in note for key in pair)


def test_keys_of_different_sizes_do_not_contradict():
    """Every key at once but for those of a size that has been named already."""
    taken, said = set[str](), []
    for key in reversed(keys()):
        if not sizes(key) & taken and key[0] != "parts":
            taken |= sizes(key)
            said.append((key, value(key)))
    assert len(said) > 40
    InfantSpec.model_validate({**HEAD, "body": body(*said)})


def test_a_factor_of_one_says_nothing():
    spec = {"measurements": {"head_circumference_cm": 44}, "parts": {"head": {"girth": 1, "length": 1.1}}}
    found = InfantSpec.model_validate({**HEAD, "body": spec})
    assert [naming.path[1] for naming in namings(found.body)] == ["measurements"]


def test_of_a_percentile_and_the_measure_on_its_chart_the_measure_is_built():
    """A girl's median length at 9 months is 70.1435 cm; charts print 70.1."""
    individual = {"sex": "female", "length_percentile": 50, "length_cm": 70.1}
    bundle = mimoc.build(InfantSpec.model_validate({**HEAD, "body": {"individual": individual}}))
    assert bundle.manifest.child.length_cm == pytest.approx(70.1, abs=1e-4)
    assert (
        "'body.individual.length_percentile' and 'body.individual.length_cm' say the same" in bundle.manifest.notes[0]
    )
