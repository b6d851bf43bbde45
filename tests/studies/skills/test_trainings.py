"""Skills that are trained on a device, all ages side by side: here on `warp:cpu`, for a few control steps."""

import pytest

import mimoc
from mimoc.schema.infant import InfantSpec
from mimoc.studies.skills import trainings
from mimoc.studies.skills.learning import CHILD, learn_skill

pytestmark = pytest.mark.usefixtures("kernels_compiled_quickly")


def child(kind: str, **keys: object) -> InfantSpec:
    return InfantSpec.model_validate({**CHILD, "age_months": 12, "task": {"kind": kind, **keys}})


def test_who_can_fall_is_helped_while_it_learns_unless_the_spec_says_otherwise():
    supports = [
        getattr(trainings.while_learning(spec).task, "support", None)
        for spec in (child("stand"), child("stand", support=0.0), child("stand", support=0.2), child("roll"))
    ]
    assert supports == [trainings.SUPPORT, 0.0, 0.2, 0.0]
    for kind in trainings.HELPED:
        child(kind, support=trainings.SUPPORT)


@pytest.mark.slow
def test_two_ages_learn_side_by_side_and_act_on_the_cpu(tmp_path, monkeypatch):
    monkeypatch.setattr(trainings, "HYPER", {"n_steps": 4, "mini_batches": 2})

    def learn():
        options = {"device": "warp:cpu", "steps": 8, "envs": 2, "seeds": 1, "starts": 1, "options": {"steps": 6}}
        return learn_skill("pull_to_stand", (0, 9, 10), tmp_path / "out", **options)

    report = learn()
    newborn, *older = [result.searches[0] for result in report.ages]
    assert "flat feet" in newborn.problem
    for attempt in older:
        assert attempt.tried == 8
        assert 0 <= attempt.success_on_device <= 1
        assert (tmp_path / "out" / attempt.policy).exists()
    assert not (tmp_path / "out" / "pull_to_stand_0_months.zip").exists()
    spec = child("pull_to_stand").with_(age_months=9)
    policy = f"skill:{tmp_path / 'out' / 'pull_to_stand_9_months.zip'}"
    assert len(mimoc.evaluate(mimoc.make(spec).unwrapped, policy, episodes=1)) == 1
    monkeypatch.setattr(trainings, "train_together", None)
    assert learn() == report
