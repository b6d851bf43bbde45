"""The infant that is to turn over: it starts as its scene says."""

import pytest

import mimoc
from mimoc.base.errors import SpecError
from mimoc.compiler.building import Builder, builder
from mimoc.schema import read_spec
from mimoc.schema.source import parse


def staged(**keys) -> Builder:
    spec = {"mimoc": 1, "name": "infant", "age_months": 9, "task": {"kind": "rollover"}, **keys}
    return builder(mimoc.InfantSpec.model_validate(spec))


@pytest.mark.parametrize("pose", ["supine", "prone"])
def test_it_starts_from_the_pose_of_the_scene_with_all_joints_free(pose):
    made = staged(scene={"pose": pose})
    assert made.manifest.pose == pose
    assert made.manifest.poses == ("supine", "prone", "sitting", "standing")
    assert all(actuator.commanded for actuator in made.manifest.actuation.actuators)
    assert not made.manifest.constraints.locks
    assert not made.manifest.constraints.welds


def test_it_has_mimos_figures_unless_told_otherwise():
    goal = staged().manifest.task
    assert (goal.steps, goal.settle_steps, goal.goal, goal.reward, goal.effort_weight) == (500, 100, 0.8, "dense", 0.01)
    goal = staged(task={"kind": "rollover", "steps": 50, "reward": "shaped"}).manifest.task
    assert (goal.steps, goal.reward) == (50, "shaped")


def test_an_infant_without_limbs_can_play():
    limbs = [f"{side}_{limb}" for side in ("left", "right") for limb in ("upper_arm", "upper_leg")]
    assert staged(body={"remove": limbs}).manifest.task.hip == "hip"


@pytest.mark.parametrize(
    ("scene", "problem"),
    [
        (
            "{kind: empty}",
            "x.yaml:4:15: scene.kind: task 'rollover' requires scene.kind: flat or crib or room; change one of them",
        ),
        (
            "{pose: sitting}",
            "x.yaml:4:15: scene.pose: task 'rollover' requires scene.pose: supine or prone; change one of them",
        ),
        (
            "{pose: standing}",
            "x.yaml:4:15: scene.pose: task 'rollover' requires scene.pose: supine or prone; change one of them",
        ),
    ],
)
def test_it_needs_a_floor_and_an_infant_that_lies_on_it(scene, problem):
    text = f"mimoc: 1\nname: x\nage_months: 9\nscene: {scene}\ntask: {{kind: rollover}}\n"
    with pytest.raises(SpecError) as error:
        read_spec(parse(text, "x.yaml"))
    assert str(error.value) == problem
