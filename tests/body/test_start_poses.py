"""Start poses rest: without commands, hands and feet stay where they are, and nothing is deep in anything."""

from itertools import pairwise

import mujoco
import numpy as np
import pytest
from support.full import full_but
from support.start_poses import DEPTH_M, MOVED_M, held_dofs, rests, spec_of

import mimoc
from mimoc.body.poses import POSES
from mimoc.bundle.model import load_model
from mimoc.compiler.building import build, builder

BODIES = [(0, "mitten"), (0.6, "mitten"), (6, "mitten"), (18, "mitten"), (0, "five_finger"), (3, "five_finger")]
CHILDREN = [
    {"sex": "female", "length_percentile": percentile, "weight_percentile": percentile} for percentile in (3, 97)
]


@pytest.mark.parametrize("development", full_but(["maturing"], ["published"]))
@pytest.mark.parametrize(("age_months", "hands"), [*BODIES, (24, "five_finger")])
def test_infants_rest_in_every_pose(age_months, hands, development):
    for found in rests(spec_of(age_months, hands, development=development)):
        assert found.at_rest, str(found)


@pytest.mark.parametrize("individual", CHILDREN, ids=str)
@pytest.mark.parametrize("age_months", [0, 12])
def test_small_and_large_children_rest_in_every_pose(age_months, individual):
    for found in rests(spec_of(age_months, body={"individual": individual})):
        assert found.at_rest, str(found)


def test_servos_hold_every_pose():
    for found in rests(spec_of(6, actuation={"model": "position"})):
        assert found.at_rest, str(found)


def test_muscles_without_commands_move_hands_a_little():
    for found in rests(spec_of(6, actuation={"model": "muscle"})):
        assert found.moved_m < 1.5 * MOVED_M, str(found)
        assert found.depth_m < DEPTH_M, str(found)


@pytest.mark.parametrize("task", ["reach", "selfbody", "catch", "standup", "rollover"])
@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_infants_rest_where_tasks_begin(task, hands):
    starts = [
        found
        for found in rests(spec_of(12, hands, task={"kind": task}, body={"chest_joint": False}))
        if found.pose in (task, "supine", "prone")
    ]
    assert starts
    for found in starts:
        assert found.at_rest, str(found)


@pytest.mark.parametrize("scene", [{"kind": "crib"}, {"kind": "room"}, {"kind": "flat", "held": ["chest"]}], ids=str)
def test_infants_rest_in_every_scene(scene):
    """Foam gives way by some millimetres: what sinks into the mattress does not count as deep."""
    for found in rests(spec_of(9, scene={**scene, "pose": "sitting"})):
        assert found.at_rest or (found.between[0] == "crib_sheet" and found.start_depth_m < DEPTH_M), str(found)


def test_newborns_lie_flexed_with_closed_hands():
    """Hips 60 to 90 degrees, knees and elbows about 90 (Amiel-Tison), fingers closed; at 12 months no more."""
    supine = {}
    for age_months in (0, 12):
        model = load_model(build(spec_of(age_months)))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("supine").id)
        supine[age_months] = {
            joint: data.joint(f"robot:left_{joint}").qpos[0] for joint in ("hip1", "knee", "elbow", "fingers")
        }
    newborn, toddler = supine[0], supine[12]
    assert newborn["hip1"] < -0.9
    assert newborn["knee"] < -1.5
    assert newborn["elbow"] < -1.4
    assert newborn["fingers"] < -1.7
    assert all(angle > -0.7 for angle in toddler.values())


def test_what_strength_holds_is_of_trunk_neck_and_legs():
    assert POSES["supine"].held == POSES["prone"].held == ()
    groups = builder(spec_of(9)).tree.muscle_groups
    model = load_model(build(spec_of(9)))
    for pose in ("sitting", "standing"):
        held = {model.joint(int(model.dof_jntid[dof])).name for dof in held_dofs(model, pose)}
        assert {groups[joint] for joint in held} == {"trunk", "neck", "left_leg", "right_leg"}


@pytest.mark.parametrize("hands", ["mitten", "five_finger"])
def test_newborns_slump_as_they_sit_less_from_month_to_month(hands):
    months = (0, 1, 2, 3, 4, 6)
    trunks_deg, heads_deg = zip(*(leaning_deg(spec_of(month, hands)) for month in months), strict=True)
    assert trunks_deg[0] > 30 > 20 > trunks_deg[-1]
    assert heads_deg[0] > trunks_deg[0] + 15
    assert all(younger >= older - 1.5 for younger, older in pairwise(trunks_deg))
    assert all(younger >= older - 1.5 for younger, older in pairwise(heads_deg))
    assert heads_deg[4] == pytest.approx(trunks_deg[4], abs=1)


@pytest.mark.parametrize(
    ("sections", "is_upright"),
    [
        ({"scene": {"pose": "sitting", "held": ["chest"]}}, True),
        ({"scene": {"pose": "sitting", "held": ["head"]}}, True),
        ({"scene": {"pose": "sitting", "held": ["hip"]}}, False),
        ({"development": "published"}, True),
    ],
    ids=str,
)
def test_newborns_sit_upright_who_are_held_by_chest_or_head_and_those_of_the_published_law(sections, is_upright):
    trunk_deg, head_deg = leaning_deg(spec_of(0, **sections))
    assert (trunk_deg < 20) == is_upright
    assert (head_deg < 20) == is_upright


def test_newborns_that_sit_have_half_closed_mittens_which_open_by_three_months():
    closed_deg = []
    for age_months in (0, 0.5, 1, 3):
        model = load_model(build(spec_of(age_months)))
        data = mujoco.MjData(model)
        mujoco.mj_resetDataKeyframe(model, data, model.key("sitting").id)
        closed_deg.append(-np.degrees(data.joint("robot:left_fingers").qpos[0]))
    assert closed_deg[0] > 85
    assert closed_deg[0] > closed_deg[1] > closed_deg[2] > closed_deg[3]


def leaning_deg(spec: mimoc.InfantSpec) -> tuple[float, float]:
    """Return how far chest and head lean forward in the pose `sitting`, in degrees."""
    model = load_model(build(spec))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key("sitting").id)
    mujoco.mj_forward(model, data)
    chest, head = (np.degrees(np.arcsin(-data.body(name).xmat[6])) for name in ("chest", "head"))
    return float(chest), float(head)
