"""Figures that ship with mimoc are of the bodies that it has, which a digest tells apart."""

import re
from pathlib import Path

import pytest

from mimoc.compiler import pipeline
from mimoc.schema.infant import InfantSpec
from mimoc.studies.bodies import bodies_digest
from mimoc.studies.skills.learning import CHILD, bodies_of, shipped_skills

CHECKOUT = Path(__file__).resolve().parents[2]
COLUMNS = (("maturing", "torque"), ("maturing", "muscle"), ("published", "torque"))
"""Laws and actuation models of the table of milestones; its column of servos says itself of which bodies it is."""


def child(**keys) -> InfantSpec:
    return InfantSpec.model_validate({"mimoc": 1, "name": "kim", "age_months": 6} | keys)


@pytest.fixture(scope="module")
def digest() -> str:
    return bodies_digest([child()])


def test_what_moves_nothing_is_not_in_the_digest(digest):
    other = child(name="lee", senses={"touch": {}, "vision": {}}, delays={"preset": "physiological"})
    assert bodies_digest([other]) == digest


@pytest.mark.parametrize(
    "keys",
    [{"age_months": 6.1}, {"actuation": {"strength": {"arms": 0.99}}}, {"scene": {"kind": "room"}}],
    ids=lambda keys: next(iter(keys)),
)
def test_what_moves_otherwise_changes_the_digest(keys, digest):
    assert bodies_digest([child(**keys)]) != digest


def test_a_bundle_has_the_digest_of_its_spec_and_order_matters():
    first, second = child(), child(age_months=9)
    both = bodies_digest([first, second])
    assert bodies_digest([pipeline.build(first), pipeline.build(second)]) == both
    assert bodies_digest([second, first]) != both
    assert re.fullmatch("[0-9a-f]{16}", both)


@pytest.mark.parametrize("report", shipped_skills().skills, ids=lambda report: report.skill)
def test_results_of_skills_are_of_todays_bodies(report):
    today = bodies_of(InfantSpec.model_validate(CHILD), [result.age_months for result in report.ages])
    renew = f"learn it again (docs/skills.md): mimoc/studies/skills/results/{report.skill}.json"
    assert report.bodies == today, f"{renew} is of the bodies {report.bodies}, today's are {today}"


def test_the_table_of_milestones_is_of_todays_bodies():
    page = (CHECKOUT / "docs" / "milestones.md").read_text(encoding="utf-8")
    today = bodies_digest(
        child(age_months=age_months, development=law, actuation={"model": model})
        for law, model in COLUMNS
        for age_months in (0, 6, 12)
    )
    (measured,) = re.findall(r"of the bodies `(\w+)`", page)
    renew = "renew the table of docs/milestones.md with 'mimoc validate --against milestones'"
    assert measured == today, f"{renew}: it is of the bodies {measured}, today's are {today}"
