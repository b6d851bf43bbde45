"""A file of a world with several infants: what it may say, and what is wrong in it or in the infants' files."""

import pytest
from support.worlds import ANNA, BEN, plan, written

import mimoc
from mimoc.base.errors import SpecError
from mimoc.schema.world import MAX_NAME, in_world, plan_of

PAIR = "infants: [anna.yaml, ben.yaml]\n"


def problems(folder, text: str, **infants) -> list[str]:
    """Return what is wrong, without the folder."""
    with pytest.raises(SpecError) as refusal:
        plan(written(folder, text, **infants))
    return str(refusal.value).replace(f"{folder}/", "").splitlines()


def test_infants_are_named_by_their_specs_or_by_the_world(tmp_path):
    text = "infants: [anna.yaml, {spec: ben.yaml, name: kim, y_cm: 40, yaw_deg: 90}]\n"
    read = plan(written(tmp_path, text, anna=ANNA, ben=BEN))
    assert list(read.infants) == ["anna", "kim"]
    assert [item.y_cm for item in read.spec.placed] == [None, 40.0]


def test_the_problems_of_all_files_are_told_with_file_and_line(tmp_path):
    (tmp_path / "ben.yaml").write_text("mimoc: 1\nname: ben\nage_month: 3\n")
    refused = problems(tmp_path, "infants: [anna.yaml, ben.yaml, none.yaml]\n", anna=ANNA)
    assert any(line.startswith("ben.yaml:3:1: age_month: unknown key; did you mean 'age_months'?") for line in refused)
    assert any(line.startswith("world.yaml:3:32: infants[2]: none.yaml: the file does not exist") for line in refused)


@pytest.mark.parametrize(
    ("text", "where", "what"),
    [
        ("infants: []\n", "world.yaml:3:10: infants", "this list is empty"),
        ("infants: [anna.yaml, anna.yaml]\n", "world.yaml:3:22: infants[1]", "is the name of another infant as well"),
        (
            "infants: [anna.yaml, {spec: ben.yaml, name: anna_b}]\n",
            "world.yaml:3:22: infants[1]",
            "'anna_b' and 'anna' are too alike",
        ),
        ("infants: [{spec: anna.yaml, x_cn: 3}, ben.yaml]\n", "world.yaml:3:29: infants[0].x_cn", "'x_cm'"),
        (PAIR + "scene: {pose: sitting}\n", "world.yaml:4:15: scene.pose", "each infant of a world has its own"),
        ("infants: [anna.yaml, world.yaml]\n", "world.yaml:3:1: infants", "this file describes a world"),
        ("infants: [anna.yaml, 3]\n", "world.yaml:3:22: infants[1]", "an infant; write the path of its spec"),
        (
            f"infants: [{{spec: anna.yaml, name: {'a' * (MAX_NAME + 1)}}}]\n",
            "world.yaml:3:35: infants[0].name",
            "",
        ),
    ],
)
def test_what_is_wrong_is_said_where_it_is(tmp_path, text, where, what):
    refused = problems(tmp_path, text, anna=ANNA, ben=BEN)
    assert any(line.startswith(f"{where}: ") and what in line for line in refused), refused


def test_infants_of_a_world_live_by_the_same_clock(tmp_path):
    slow = {**BEN, "control": {"step_ms": 20}}
    (refused,) = problems(tmp_path, PAIR, anna=ANNA, ben=slow)
    assert refused == (
        "world.yaml:3:22: infants[1]: 'ben' has a control step of 20 ms and 'anna' one of 10 ms; "
        "write the same control.step_ms in both specs"
    )


def test_an_infant_is_in_the_scene_of_its_world_in_its_own_pose():
    anna = mimoc.InfantSpec.model_validate({**ANNA, "scene": {"kind": "crib", "pose": "prone", "seed": 3}})
    there = in_world(plan_of({"anna": anna}, scene={"kind": "empty"}), "anna")
    assert (there.scene.kind, there.scene.pose, there.scene.seed) == ("empty", "prone", 0)


def test_a_task_that_needs_another_scene_is_refused_in_the_file_of_the_world(tmp_path):
    turning = {**ANNA, "task": {"kind": "rollover"}}
    read = plan(written(tmp_path, PAIR + "scene: {kind: empty}\n", anna=turning, ben=BEN))
    with pytest.raises(SpecError, match=r"world.yaml:3:11: infants\[0\]: in the scene of this world, scene.kind: task"):
        in_world(read, "anna")


def test_where_one_infant_is_wanted_a_world_is_refused_in_one_line(tmp_path):
    path = written(tmp_path, PAIR, anna=ANNA, ben=BEN)
    for read in (mimoc.load_spec, mimoc.build, mimoc.make):
        with pytest.raises(SpecError, match=r"world.yaml:3:1: infants: this file describes a world with several"):
            read(path)


def test_where_infants_start_is_said_of_each():
    scene = {"start_at": "rail", "objects": [{"kind": "rail", "name": "rail"}]}
    with pytest.raises(
        SpecError, match=r"scene\.start_at: each infant of a world starts in its own place; write \{spec"
    ):
        plan_of({"kim": mimoc.InfantSpec(mimoc=1, name="kim", age_months=9)}, scene=scene)
