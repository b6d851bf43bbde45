"""Policies of infants that share a world: one of each, what they aim at, and where their episodes begin."""

from contextlib import closing
from typing import Any

import numpy as np
import pytest
from support.motions import moved
from support.store import built, made_once
from support.worlds import placed

import mimoc
from mimoc.base.errors import PolicyError, UnknownNameError
from mimoc.policies.behaviours.aiming import find_target
from mimoc.policies.behaviours.behaviour import Subject
from mimoc.policies.control.infant import DrivenInfant
from mimoc.policies.named import policies_of, policy_of
from mimoc.policies.rollout import Run
from mimoc.policies.spec import parse_policies
from mimoc.runtime.world_env import WorldEnv

NAMES = "anna", "ben", "lean"


@pytest.mark.parametrize(
    ("text", "policies"),
    [
        ("sit", ["sit", "sit", "sit"]),
        ("sit:lean=0.4,knees_deg=-30", ["sit:lean=0.4,knees_deg=-30"] * 3),
        ("anna=sit,ben=general_movements+reflexes", ["sit", "general_movements+reflexes", None]),
        (" anna = reach_for:toy,right , ben=zero", ["reach_for:toy,right", "zero", None]),
        (
            "ben=look_at(0.3, 0, 0.2)+kick,anna=sit:knees_deg=-30,lean=zero",
            ["sit:knees_deg=-30", "look_at(0.3, 0, 0.2)+kick", "zero"],
        ),
        ("anna=sit(lean=0.4,knees_deg=-30),lean=zero", ["sit(lean=0.4,knees_deg=-30)", None, "zero"]),
        ("runs/a=b/policy.zip", ["runs/a=b/policy.zip"] * 3),
        ("anna=runs/a=b/policy.zip", ["runs/a=b/policy.zip", None, None]),
    ],
)
def test_a_text_says_the_policy_of_each_infant(text, policies):
    wanted = {name: policy for name, policy in zip(NAMES, policies, strict=True) if policy}
    assert parse_policies(text, NAMES) == wanted


@pytest.mark.parametrize(
    ("text", "error", "reason"),
    [
        ("bob=sit", UnknownNameError, "'bob' is not a name of an infant of this world"),
        ("anna=sit,bob=zero", UnknownNameError, "'bob' is not a name of an infant of this world"),
        ("anna=sit,anna=kick", PolicyError, "'anna' has two policies"),
        ("anna=,ben=kick", PolicyError, "there is no policy behind 'anna='; write anna=NAME, such as sit"),
    ],
)
def test_policies_that_fit_no_infants_are_refused(text, error, reason):
    with pytest.raises(error, match=reason):
        parse_policies(text, NAMES)


SITTING: dict[str, Any] = {
    "mimoc": 1,
    "name": "kim",
    "age_months": 9,
    "senses": {"proprioception": {}, "vestibular": {}},
    "scene": {"pose": "sitting"},
}
FACE_TO_FACE = {"y_cm": 26.0, "yaw_deg": -90.0}, {"y_cm": -26.0, "yaw_deg": 90.0}


@pytest.fixture(scope="module")
def world():
    """Return two infants who sit face to face, with a toy beside them."""
    infants = {"anna": SITTING, "ben": {**SITTING, "delays": {"preset": "physiological"}}}
    scene = {"kind": "flat", "toys": {"subset": ["ball"], "count": [1, 1]}}
    bundle = made_once("face to face", lambda: placed(infants, *FACE_TO_FACE, scene=scene))
    with closing(WorldEnv(bundle)) as env:
        yield env


def ran(world, policies, steps) -> Any:
    run = Run(world, policies, seed=0)
    for _ in range(steps):
        run.step()
    return run.summaries()


def test_each_infant_has_a_policy_of_its_own(world):
    world.reset(seed=0)
    acting = policies_of(world.infants, "anna=sit,ben=reflexes")
    assert [type(policy).__name__ for policy in acting.values()] == ["BehaviourPolicy", "OfOne"]
    one, other = policies_of(world.infants, "kick").values()
    assert one is not other
    summaries = ran(world, {"anna": "sit"}, 3)
    assert summaries["anna"].metrics["held_share"]
    assert not summaries["ben"].metrics  # It commands nothing.
    assert [len(summaries[name].notes) for name in ("anna", "ben")] == [1, 0]


def test_a_policy_of_no_infant_is_refused(world):
    with pytest.raises(UnknownNameError, match="'bob' is not a name of an infant of this world"):
        policies_of(world.infants, {"bob": "sit"})


def test_infants_look_at_each_other(world):
    summaries = ran(world, "anna=sit+look_at(ben),ben=sit+look_at:anna_right_hand", 120)
    assert all(summary.metrics["held_share"] for summary in summaries.values())
    assert summaries["anna"].metrics["gaze_error_deg"] < 10
    assert summaries["ben"].metrics["gaze_error_deg"] < 15  # At first, 46: it faces her head.


@pytest.mark.parametrize(
    ("word", "body"),
    [
        ("head", "ben_head"),
        ("right_hand", "ben_right_hand"),
        ("ben_right_hand", "ben_right_hand"),
        ("anna_right_hand", "anna_right_hand"),
        ("anna", "anna_head"),
        ("toy", "toy1_ball"),
        ("ball", "toy1_ball"),
    ],
)
def test_a_target_is_a_part_of_the_infant_itself_or_of_another(world, word, body):
    infant = world.infants["ben"]
    subject = Subject(DrivenInfant.of(infant.model, infant.manifest), infant.manifest)
    assert find_target(subject, "look_at", word).bodies == (infant.model.body(body).id,)


def test_parts_of_a_subject_are_those_of_its_own_infant(world):
    infant = world.infants["ben"]
    subject = Subject(DrivenInfant.of(infant.model, infant.manifest), infant.manifest)
    arm = subject.bodies_below("right_upper_arm")
    assert arm == subject.bodies_below("ben_right_upper_arm")
    assert {subject.infant.part(body) for body in arm} >= {"right_upper_arm", "right_hand"}
    assert all(world.model.body(body).name.startswith("ben_") for body in arm)
    assert subject.infant.body("head") == world.model.body("ben_head").id


def test_a_target_that_there_is_not_is_refused_with_those_that_are_near(world):
    with pytest.raises(UnknownNameError, match="did you mean 'anna_right_hand'"):
        policy_of(world.infants["ben"], "look_at:anna_rigth_hand")


def test_a_posture_moves_no_other_infant(world):
    world.reset(seed=0)
    ben, before = world.infants["ben"], world.data.qpos.copy()
    own = DrivenInfant.of(world.model, ben.manifest)
    policy: Any = policy_of(ben, "kick")
    policy.begin()
    changed = np.flatnonzero(world.data.qpos != before)
    joints = np.searchsorted(world.model.jnt_qposadr, changed, side="right") - 1
    assert changed.size
    assert own.is_own[world.model.jnt_bodyid[joints]].all()
    assert world.data.qpos[own.place][:2] == pytest.approx(before[own.place][:2])


def test_what_another_infant_senses_is_from_after_the_beginning(world):
    """Ben's late senses do not tell of where Anna was before her policy put her elsewhere, whatever their order."""
    run = Run(world, "anna=zero,ben=kick", seed=0)
    ben = world.infants["ben"]
    sensed = [line.state for delayed in ben.schedule.samples.values() for line in delayed]
    ben.schedule.reset(world.data)
    again = [line.state for delayed in ben.schedule.samples.values() for line in delayed]
    for one, other in zip(sensed, again, strict=True):
        assert all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))
    assert np.array_equal(run.observations["anna"]["vestibular"], world.infants["anna"].observe()["vestibular"])


def test_infants_that_would_begin_within_each_other_are_an_error(world):
    with pytest.raises(PolicyError, match="put 'anna' and 'ben' within each other; place them further apart"):
        Run(world, "prone", seed=0)


def test_a_motion_takes_place_where_the_infant_is(world, tmp_path):
    motion = moved(built(SITTING), 0.1)
    places, _ = motion.places(world.model, "ben_")
    world.reset(seed=0)
    start = world.data.qpos[places].copy()
    there = motion.moved_to(start)
    assert there.qpos[0, :2] == pytest.approx(start[:2])
    assert there.qpos[:, 2] == pytest.approx(motion.qpos[:, 2])
    assert there.qpos[0, 3:7] == pytest.approx(start[3:7], abs=1e-6)  # It sits in the motion as it does there.
    assert there.qpos[:, 7:] == pytest.approx(motion.qpos[:, 7:])
    steps_m = [np.linalg.norm(np.diff(item.qpos[:, :2], axis=0), axis=1) for item in (motion, there)]
    assert steps_m[0] == pytest.approx(steps_m[1])


def test_a_controller_takes_the_names_of_an_infant_that_is_alone(world):
    world.reset(seed=0)
    ben = world.infants["ben"]
    hand_m = ben.data.body("ben_right_hand").xipos.copy()
    reach, bent = mimoc.PositionTask("right_hand", hand_m), mimoc.Posture({"robot:left_elbow": -1.2})
    control = mimoc.InverseDynamics(ben.model, ben.data, ben.manifest, [reach, bent])
    assert control().shape == ben.action_space.shape
    assert control.errors() == pytest.approx([0.0])
    assert "robot:left_elbow" in control.joints
    other = mimoc.InverseDynamics(ben.model, ben.data, ben.manifest, [mimoc.PositionTask("anna_head", hand_m)])
    assert other.errors()[0] > 0.1


@pytest.mark.full
def test_behaviours_go_on_while_infants_grow():
    kim = mimoc.InfantSpec.model_validate(SITTING)
    with closing(mimoc.make_parallel({"anna": kim, "ben": kim})) as world:
        run = Run(world, "anna=sit+look_at(ben_right_hand),ben=sit+reach_for(anna_head)", seed=0)
        for step in range(30):
            if step == 10:
                run.observations = world.grow({"ben": 12.0})
            run.step()
        assert world.infants["ben"].age_months == 12.0
        assert all(summary.metrics["held_share"] for summary in run.summaries().values())
