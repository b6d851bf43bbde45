"""A child that there is none of: the line that made it, what is wrong and what to write instead, as golden texts.

Renew them with `pytest --snapshot-update`, and read the difference.
"""

import re
from pathlib import Path

import pytest

import mimoc
from mimoc.base.errors import SpecError
from mimoc.schema import InfantSpec, read_spec
from mimoc.schema.source import parse

HEAD = "mimoc: 1\nname: x\nage_months: 9\nbody:\n"

BODIES = {
    "a part made thick": "  parts:\n    left_upper_leg: {girth: 1.9}\n",
    "a part made short": "  parts:\n    right_lower_arm: {length: 0.5}\n",
    "a part made short and thick": "  parts:\n    left_upper_leg: {length: 0.6, girth: 1.5}\n",
    "a part made short and thick by both together": "  parts:\n    left_upper_leg: {length: 0.8, girth: 1.4}\n",
    "one of several parts": "  parts:\n    left_foot: {length: 2}\n    left_upper_leg: {girth: 1.9}\n",
    "a thick thigh": "  measurements: {mid_thigh_circumference_cm: 40}\n",
    "a thick thigh after a harmless foot": "  measurements: {foot_length_cm: 12, mid_thigh_circumference_cm: 40}\n",
    "one thick arm": "  measurements:\n    left_forearm_circumference_cm: 27\n",
    "a short foot on one side": "  measurements: {right_foot_length_cm: 12, left_foot_length_cm: 4.3}\n",
    "a broad foot": "  measurements: {foot_length_cm: 7, foot_breadth_cm: 8}\n",
    "a broad hand": "  measurements: {hand_breadth_cm: 8.5}\n",
    "a broad fist": "  measurements: {maximum_fist_breadth_cm: 9}\n",
    "a thick ankle": "  measurements: {ankle_circumference_cm: 24, knee_sole_length_cm: 9}\n",
    "a short forearm": "  measurements: {elbow_hand_length_cm: 9}\n",
    "a thick finger": "  hands: five_finger\n  measurements: {left_middle_finger_diameter_cm: 1.5}\n",
    "a short hand of five fingers": "  hands: five_finger\n  measurements: {hand_length_cm: 4}\n",
    "narrow hips": "  measurements: {hip_breadth_cm: 8}\n",
    "narrow shoulders": "  measurements: {shoulder_breadth_cm: 9}\n",
    "a deep chest": "  measurements: {chest_circumference_cm: 60}\n",
    "no room for a trunk": "  measurements: {crown_rump_length_cm: 20}\n",
    "no room for legs": "  measurements: {crown_sole_length_cm: 42}\n",
    "a measurement of an individual": "  individual: {length_cm: 60}\n  measurements: {rump_knee_length_cm: 8}\n",
    "a part of an individual": "  individual: {weight_kg: 11}\n  parts: {left_upper_leg: {girth: 2}}\n",
}


def problem_of(body: str, folder: Path):
    (folder / "spec.yaml").write_text(HEAD + body)
    with pytest.raises(SpecError) as refusal:
        mimoc.build(mimoc.load_spec(folder / "spec.yaml"))
    (problem,) = refusal.value.problems
    return problem


@pytest.mark.parametrize("case", BODIES)
def test_an_impossible_body_gets_this_text(case, tmp_path, snapshot):
    problem = problem_of(BODIES[case], tmp_path)
    assert str(problem).replace(f"{tmp_path}/", "") == snapshot
    line = (HEAD + BODIES[case]).splitlines()[problem.line - 1]
    assert problem.key.split(".")[-1] in line
    assert [path.name for path in tmp_path.iterdir()] == ["spec.yaml"], "and nothing is built"


@pytest.mark.parametrize("case", BODIES)
def test_taking_the_advice_builds(case, tmp_path):
    """And what is said to be the bound is one: a little beyond it there is no such child."""
    problem = problem_of(BODIES[case], tmp_path)
    key = problem.key.split(".")[-1]
    bound = float(re.search(r"(?:below|above|less than|more than) ([\d.]+)(?: cm)?$", problem.message)[1])
    advice = problem.message.split("; give ")[1]
    little = 0.02 if advice.startswith("a ") else 0.2
    beyond = bound + (little if re.search("below|less", advice) else -little)
    for value, is_possible in ((bound, True), (beyond, False)):
        text = HEAD + "".join(_with(line, key, value, problem.line) for line in _numbered(BODIES[case]))
        spec = read_spec(parse(text, "spec.yaml"))
        if is_possible:
            assert mimoc.build(spec).files
        else:
            with pytest.raises(SpecError, match="body"):
                mimoc.build(spec)


def _numbered(body: str) -> list[tuple[int, str]]:
    return list(enumerate(body.splitlines(keepends=True), start=len(HEAD.splitlines()) + 1))


def _with(numbered: tuple[int, str], key: str, value: float, line: int) -> str:
    number, text = numbered
    return re.sub(rf"\b{key}: [\d.]+", f"{key}: {value}", text) if number == line else text


def test_a_problem_of_a_spec_from_python_names_its_key():
    spec = InfantSpec.model_validate(
        {"mimoc": 1, "name": "x", "age_months": 9, "body": {"parts": {"left_upper_leg": {"girth": 2.0}}}}
    )
    with pytest.raises(SpecError, match=r"^<x>: body.parts.left_upper_leg.girth: a limb"):
        mimoc.build(spec)


@pytest.mark.parametrize("keys", [("left_foot", "left_upper_leg"), ("left_upper_leg", "left_foot")])
def test_the_order_of_lines_does_not_matter(keys):
    parts = {"left_foot": "{length: 2.0}", "left_upper_leg": "{girth: 1.9}"}
    text = HEAD + "  parts:\n" + "".join(f"    {key}: {parts[key]}\n" for key in keys)
    with pytest.raises(SpecError, match=r"left_upper_leg\.girth"):
        mimoc.build(read_spec(parse(text, "spec.yaml")))
