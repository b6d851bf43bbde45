"""Every number of a task says what it is."""

import pytest

import mimoc
from mimoc.compiler.explain import entries_of, explain
from mimoc.schema.components.tasks import TASKS

KINDS = [kind for kind in TASKS if kind != "free"]


@pytest.mark.parametrize("kind", KINDS)
def test_every_number_of_a_task_can_be_explained(kind):
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "task": {"kind": kind}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(spec))
    numbers = {name: value for name, value in bundle.manifest.task.model_dump().items() if isinstance(value, float)}
    for name, value in numbers.items():
        explained = explain(bundle, f"task.{kind}.{name}")
        assert str(explained)
        assert entries_of(bundle)[f"task.{kind}.{name}"]["value"] == value
