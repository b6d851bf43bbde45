"""The belly is solid: it carries what lies on it, rests on the ground, and feels both."""

import itertools
import re
from collections.abc import Iterator

import mujoco
import numpy as np
import pytest
from support import store
from support.full import full_but
from support.start_poses import DEPTH_M

import mimoc
from mimoc.body.poses import POSES
from mimoc.bundle.model import in_subtrees, load_model
from mimoc.components.senses.touch.run import bind
from mimoc.schema.names import SIDES

BELLY = "cb"
HEELS = {"left_foot1", "right_foot1"}
BELLY_HANDS = ("mitten", "five_finger")
AGES_MONTHS = (0, 2, 6, 12, 18, 24)
BALL_RADIUS_M, BALL_MASS_KG = 0.03, 0.05
BALL = """
<body name="ball" pos="{x} {y} {z}"><freejoint/><geom name="ball" size="{radius}" mass="{mass}" condim="6"/></body>
"""
SETTLED, COUNTED = 60, 40
"""Physics steps after which a ball has come to rest, and over which what it presses with is averaged."""
CHILDREN = [(age, hands) for age in (0, 9, 24) for hands in BELLY_HANDS]


def bundle_of(age_months: float, hands: str, **keys) -> mimoc.Bundle:
    spec = {"mimoc": 1, "name": "x", "age_months": age_months, "body": {"hands": hands}}
    scene = {"kind": "flat", "pose": "supine"}
    return store.built({**spec, "scene": scene, **keys})


def above_belly(data: mujoco.MjData) -> np.ndarray:
    """Return where a ball is let go, a centimetre above the belly, shape (3,), [m]."""
    belly = data.geom(BELLY)
    return belly.xpos + np.array([0, 0, data.model.geom(BELLY).size[0] + BALL_RADIUS_M + 0.01])


def with_ball(bundle: mimoc.Bundle) -> mujoco.MjModel:
    """Return the scene of a bundle with a ball just above the belly of an infant whose joints hold still."""
    plain = load_model(bundle)
    data = mujoco.MjData(plain)
    mujoco.mj_resetDataKeyframe(plain, data, plain.key("supine").id)
    mujoco.mj_kinematics(plain, data)
    x, y, z = above_belly(data)
    ball = BALL.format(x=x, y=y, z=z, radius=BALL_RADIUS_M, mass=BALL_MASS_KG)
    scene = re.sub("(?s)<keyframe>.*</keyframe>", "", bundle.files["scene.xml"].decode())
    scene = scene.replace("</worldbody>", ball + "</worldbody>")
    model = mujoco.MjModel.from_xml_string(scene, dict(bundle.files))
    model.dof_armature[6 : plain.nv] = 1e3  # As stiff as a statue.
    return model


def supine(bundle: mimoc.Bundle, model: mujoco.MjModel) -> mujoco.MjData:
    """Return the state in which the infant lies on its back."""
    data, start = mujoco.MjData(model), load_model(bundle).key("supine").qpos
    data.qpos[: len(start)] = start
    return data


def meetings(data: mujoco.MjData) -> Iterator[tuple[set[str], np.ndarray]]:
    """Yield the two geoms of each contact and its force on the second, in the world."""
    for index, contact in enumerate(data.contact):
        wrench = np.zeros(6)
        mujoco.mj_contactForce(data.model, data, index, wrench)
        yield {data.model.geom(geom).name for geom in contact.geom}, contact.frame.reshape(3, 3).T @ wrench[:3]


@pytest.mark.parametrize(("age_months", "hands"), CHILDREN)
def test_a_ball_dropped_on_the_belly_stays_on_it_and_is_sensed(age_months, hands):
    bundle = bundle_of(age_months, hands, senses={"touch": {}})
    model = with_ball(bundle)
    data, touch = supine(bundle, model), bind(bundle.manifest.senses.touch, model, bundle)
    on_belly = touch.receptors.names == "lower_body"
    pressed_n, sensed_n = 0.0, 0.0
    for step in range(SETTLED + COUNTED):
        mujoco.mj_step(model, data)
        if step >= SETTLED:
            found = {frozenset(pair): force for pair, force in meetings(data)}
            pressed_n += np.linalg.norm(found.get(frozenset((BELLY, "ball")), np.zeros(3))) / COUNTED
            sensed_n += np.linalg.norm(touch(data).reshape(len(on_belly), -1)[on_belly].sum(axis=0)) / COUNTED
    height_m = data.body("ball").xpos[2] - data.geom(BELLY).xpos[2]
    assert height_m == pytest.approx(model.geom(BELLY).size[0] + BALL_RADIUS_M, abs=0.005)
    assert pressed_n == pytest.approx(BALL_MASS_KG * 9.81, rel=0.02)
    assert sensed_n == pytest.approx(pressed_n, rel=0.01)


@pytest.mark.parametrize("hands", BELLY_HANDS)
@pytest.mark.parametrize("chest_joint", [False, True])
@pytest.mark.parametrize("ages_months", full_but([AGES_MONTHS[::8]], [AGES_MONTHS]), ids=["few", "all"])
def test_only_arms_meet_the_infant_itself_in_any_pose(hands, chest_joint, bundle_at, ages_months):
    """Only neighbours may share room; slack arms lie on the trunk and the thighs, and fingers on each other.

    Tone draws up the legs of newborns, who lie with heels together on their belly.
    """
    for age_months in ages_months:
        model = load_model(bundle_at(age_months, hands, chest_joint))
        of_arms = in_subtrees(model, [model.body(f"{side}_upper_arm").id for side in SIDES])[model.geom_bodyid]
        for pose in POSES:
            data = posed(model, pose)
            own = [contact for contact in data.contact if model.geom("floor").id not in contact.geom]
            others = [contact.geom for contact in own if not of_arms[contact.geom].any()]
            if (age_months, pose) == (0, "prone"):
                others = [pair for pair in others if {model.geom(geom).name for geom in pair} != HEELS]
            assert not others, (age_months, pose)
            assert all(contact.dist > -DEPTH_M for contact in own), (age_months, pose)


@pytest.mark.parametrize("hands", BELLY_HANDS)
@pytest.mark.parametrize("chest_joint", [False, True])
def test_an_infant_that_lies_rests_on_its_trunk(hands, chest_joint, bundle_at):
    """On its belly on the upper, on its back on the lower end, once the few points give way that it is laid down on."""
    for age_months, (pose, end) in itertools.product(AGES_MONTHS, {"prone": "ub1", "supine": "lb"}.items()):
        model = load_model(bundle_at(age_months, hands, chest_joint))
        data = posed(model, pose)
        mujoco.mj_step(model, data, nstep=SETTLED)
        assert {end, "floor"} in [pair for pair, _ in meetings(data)], (age_months, pose)


def posed(model: mujoco.MjModel, pose: str) -> mujoco.MjData:
    """Return an infant in a pose."""
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_forward(model, data)
    return data


@pytest.mark.parametrize("chest_joint", [False, True])
def test_eyes_pass_through_the_whole_upper_body(chest_joint, infant_at):
    model = infant_at(9, "mitten", chest_joint).model
    pairs = [divmod(int(signature), 2**16) for signature in model.exclude_signature]
    excluded = {frozenset((model.body(a).name, model.body(b).name)) for a, b in pairs}
    for eye in ("left_eye", "right_eye"):
        assert {frozenset((eye, "upper_body")), frozenset((eye, "chest"))} <= excluded
