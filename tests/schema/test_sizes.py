"""No size of a body has two values, whichever two keys of the language name it."""

from itertools import combinations
from typing import Any

import pytest

import mimoc
from mimoc.compiler.notes import notes
from mimoc.errors import SpecError
from mimoc.fits import load_tables, measure
from mimoc.schema import InfantSpec, read_spec
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
        side, _, part = name.rpartition("left_") if "left_" in name else name.rpartition("right_")
        side = "left" if "left_" in name else "right" if "right_" in name else ""
        named = PART_SIZES.get(part, {}).get(key[2], ())
        return {f"{side}_{size}" if ("measurements", f"{side}_{size}_cm") in ALL else size for size in named}
    size = name.removesuffix("_cm")
    sided = {f"{side}_{size}" for side in ("left", "right") if ("measurements", f"{side}_{size}_cm") in ALL}
    return sided or {size}


ALL = set(keys())


def value(key: Key) -> float:
    """Return what the average girl has of a size, or a factor."""
    section, name = key[:2]
    if section == "parts":
        return 1.1
    if section == "measurements":
        return round(100 * measure(9)[name.removesuffix("_cm").removeprefix("left_").removeprefix("right_")], 1)
    indicator = {"length": "length_cm", "weight": "weight_kg", "head": "head_circumference_cm"}[name.partition("_")[0]]
    return 50.0 if "percentile" in name else round(load_tables().who[indicator].value(0, 9, "female"), 1)


def body(*said: tuple[Key, float]) -> dict[str, Any]:
    """Return a body with some keys."""
    found: dict[str, Any] = {"individual": {"sex": "female", "weight_kg": 8.0}, "hands": "mitten"}
    if any(key[0] == "individual" and "weight" in key[1] for key, _ in said):
        found["individual"] = {"sex": "female"}
    if not any(key[0] == "individual" for key, _ in said):
        del found["individual"]
    for key, size in said:
        if key[0] == "parts" and not key[1].endswith(("hand", "fingers")):
            five = key[1].rpartition("_")[2].startswith(("mf", "th", "ff", "rf", "lf", "big", "toe"))
            found["hands"] = "five_finger" if five and not key[1].endswith("toes") else found["hands"]
        section = found
        for step in key[:-1]:
            section = section.setdefault(step, {})
        section[key[-1]] = size
    return found


PAIRS = [
    pair
    for pair in combinations(keys(), 2)
    if sizes(pair[0]) & sizes(pair[1]) and {key[0] for key in pair} != {"parts"}
]


def test_there_are_pairs_of_every_two_sections():
    sections = {tuple(sorted(key[0] for key in pair)) for pair in PAIRS}
    every = {"individual", "measurements", "parts"}
    assert sections == {tuple(sorted(two)) for two in combinations(every, 2)} | {("individual",) * 2, ("measurements",) * 2}
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
        lines = [line for line, of in enumerate(text.splitlines(), 1) if of.strip().startswith(f"{pair[0][-1]}:")]
        assert problem.key in dotted, pair
        (other,) = set(dotted) - {problem.key}
        assert f"'{other}' in line " in problem.message
        assert problem.message.endswith(("leave one of the two out", "give left_ and right_ instead of both sides"))
        assert problem.line in range(1, len(text.splitlines()) + 1)
        assert lines


def test_the_same_value_twice_is_noted_and_builds():
    for pair in PAIRS:
        if "parts" not in (pair[0][0], pair[1][0]):
            first, second = pair
            again = value(first) if first[0] == second[0] == "measurements" else value(second)
            same = value(first) if "percentile" in "".join(first) else again
            twice = again if "percentile" not in "".join(second) else value(second)
            spec = InfantSpec.model_validate({**HEAD, "body": body((first, same), (second, twice))})
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
    assert "'body.individual.length_percentile' and 'body.individual.length_cm' say the same" in bundle.manifest.notes[0]
