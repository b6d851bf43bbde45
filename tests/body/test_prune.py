"""Limbs that an infant does not have: they go with everything on them, and nothing speaks of them any more."""

from itertools import combinations

import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from hypothesis import given, settings, strategies as st
from lxml import etree
from support.full import FULL, full_rows
from support.start_poses import DEPTH_M

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.compiler.explain import entries_of
from mimoc.schema import InfantSpec
from mimoc.schema.names import limb_bodies

HANDS = ("mitten", "five_finger")
SINGLE = [(hands, limb) for hands in HANDS for limb in limb_bodies(hands)]
FEW = [
    ("mitten", ["left_upper_arm"]),
    ("mitten", ["left_eye", "right_eye"]),
    ("mitten", ["left_upper_leg", "right_upper_leg"]),
    ("mitten", ["left_upper_arm", "right_upper_arm", "left_upper_leg", "right_upper_leg", "left_eye", "right_eye"]),
    ("five_finger", ["right_hand", "left_foot"]),
    ("five_finger", ["left_lfmetacarpal", "right_thhub", "left_toes"]),
]
REFERENCES = {  # Attributes of MJCF that hold a name, and of what.
    "joint": "joint", "joint1": "joint", "joint2": "joint", "site": "site", "body1": "body", "body2": "body",
    "geom1": "geom", "geom2": "geom", "tendon": "tendon", "material": "material", "texture": "texture",
}  # fmt: skip
REST_DEPTH_M = 1.1e-4


def spec(hands: str, remove=(), age_months: float = 9) -> InfantSpec:
    body = {"hands": hands, "chest_joint": True, "remove": list(remove)}
    senses = {"proprioception": {}, "vestibular": {}}
    return InfantSpec.model_validate(
        {"mimoc": 1, "name": "x", "age_months": age_months, "body": body, "senses": senses, "scene": {"kind": "flat"}}
    )


@pytest.fixture(scope="module")
def whole() -> dict[str, etree._Element]:
    return {hands: mjcf(mimoc.build(spec(hands))) for hands in HANDS}


def mjcf(bundle: mimoc.Bundle) -> etree._Element:
    return etree.fromstring(bundle.files["infant.xml"])


def gone_with(hands: str, remove) -> set[str]:
    gone = set(remove)
    for side, part in assemble(hands, True).parts:
        if part.parent and part.parent.format(side=side) in gone:
            gone.add(part.name.format(side=side))
    return gone


def check(whole: etree._Element, hands: str, remove) -> mimoc.Bundle:
    """Hold a bundle to what is left of the whole infant; return it."""
    bundle = mimoc.build(spec(hands, remove))
    xml, gone = mjcf(bundle), gone_with(hands, remove)
    expected = etree.fromstring(etree.tostring(whole))
    for body in [body for body in expected.iter("body") if body.get("name") in gone]:
        if body.getparent() is not None:
            body.getparent().remove(body)
    for kind in ("body", "joint", "geom", "site", "camera"):
        found, left = ([each.get("name") for each in tree.find("worldbody").iter(kind)] for tree in (xml, expected))
        assert found == left, (remove, kind)
    _check_references(xml, remove)
    _check_manifest(bundle, remove)
    _check_rest(bundle, remove)
    return bundle


def _check_references(xml: etree._Element, remove) -> None:
    """Every name that is referred to exists, and every element that could stay has stayed."""
    names = {(each.tag, each.get("name")) for each in xml.iter() if each.get("name")}
    for each in xml.iter():
        if isinstance(each.tag, str):
            for attribute, kind in REFERENCES.items():
                name = each.get(attribute)
                assert name is None or (kind, name) in names, (remove, each.tag, attribute, name)


def _check_manifest(bundle: mimoc.Bundle, remove) -> None:
    model = mujoco.MjModel.from_xml_string(bundle.files["scene.xml"].decode(), assets=dict(bundle.files))
    manifest = bundle.manifest
    actuators = [model.actuator(index).name for index in range(model.nu)]
    assert [entry.name for entry in manifest.actuation.actuators] == actuators, remove
    joints = [model.joint(index).name for index in range(1, model.njnt)]
    assert list(manifest.senses.proprioception.joints) == joints, remove
    sensors = [model.sensor(index).name for index in range(model.nsensor)]
    balance = [manifest.senses.vestibular.accelerometer, manifest.senses.vestibular.gyro]
    assert [*balance, *manifest.senses.proprioception.torque_sensors] == sensors, remove
    assert len(manifest.keypoints) == 25
    provenance = entries_of(bundle)
    known = {model.body(index).name for index in range(1, model.nbody)}
    assert {key.split(".")[1] for key in provenance if key.startswith("body.")} == known, remove
    assert {source for entry in provenance.values() for source in entry.get("from", ())} <= provenance.keys(), remove


def _check_rest(bundle: mimoc.Bundle, remove) -> None:
    model = mujoco.MjModel.from_xml_string(bundle.files["scene.xml"].decode(), assets=dict(bundle.files))
    data = mujoco.MjData(model)
    for key in range(model.nkey):
        mujoco.mj_resetDataKeyframe(model, data, key)
        mujoco.mj_forward(model, data)
        assert data.ncon, (remove, model.key(key).name)
        of_floor = data.contact.geom[:, 0] == model.geom("floor").id
        assert of_floor.any(), (remove, model.key(key).name)
        assert data.contact.dist[of_floor].min() >= -REST_DEPTH_M, (remove, model.key(key).name)
        assert data.contact.dist.min() > -DEPTH_M, (remove, model.key(key).name)


@pytest.mark.full
@pytest.mark.parametrize(
    ("hands", "side"),
    full_rows([("mitten", "left"), ("mitten", "right")], [("five_finger", "left"), ("five_finger", "right")]),
)
def test_any_one_limb_can_be_missing(whole, hands, side):
    for limb in limb_bodies(hands):
        if limb.startswith(side):
            bundle = check(whole[hands], hands, [limb])
            here = gone_with(hands, [limb])
            assert len(here) == len(mjcf_bodies(whole[hands])) - len(mjcf_bodies(mjcf(bundle)))


def mjcf_bodies(xml: etree._Element) -> set[str]:
    return {body.get("name") for body in xml.iter("body")}


PAIRS = [(hands, pair) for hands in HANDS for pair in combinations(limb_bodies(hands), 2)]


@FULL
@settings(max_examples=25)
@given(removed=st.sampled_from(PAIRS))
def test_any_two_of_twenty_five_pairs_of_limbs_can_be_missing(whole, removed):
    hands, pair = removed
    check(whole[hands], hands, pair)


@pytest.mark.parametrize(("hands", "remove"), FEW, ids=str)
def test_an_infant_without_them_lives(whole, hands, remove, tmp_path):
    folder = mimoc.write_bundle(check(whole[hands], hands, remove), tmp_path / "out")
    env = mimoc.make(folder)
    check_env(env.unwrapped, skip_render_check=True)
    observation, _ = env.reset(seed=0)
    for _ in range(20):
        observation, *_, info = env.step(env.action_space.sample())
        assert not info["unstable"]
    assert observation in env.observation_space
    env.close()


@pytest.mark.parametrize("hands", HANDS)
def test_removing_nothing_changes_nothing(hands):
    default = {"mimoc": 1, "name": "x", "age_months": 9, "body": {"hands": hands}}
    empty = {**default, "body": {"hands": hands, "remove": []}}
    one, other = (mimoc.build(InfantSpec.model_validate(data)).files for data in (default, empty))
    said = {"spec.yaml", "provenance.json", "lock.json"}
    assert {name: one[name] for name in one if name not in said} == {
        name: other[name] for name in other if name not in said
    }


def test_the_order_and_what_is_missing_twice_do_not_matter():
    """A hand goes with its arm, whether it is named or not."""
    one, other = (mjcf(mimoc.build(spec("mitten", names))) for names in (
        ["left_lower_arm", "right_foot"], ["right_foot", "left_hand", "left_lower_arm"],
    ))  # fmt: skip
    assert etree.tostring(one) == etree.tostring(other)


def test_what_is_left_is_as_it_was(infant_at, infant_with):
    before, after = infant_at(9), infant_with(remove=["left_upper_arm"])
    for index in range(1, after.model.nbody):
        name = after.model.body(index).name
        assert after.data.body(name).xpos == pytest.approx(before.data.body(name).xpos, abs=1e-9), name
        assert after.model.body(name).mass == before.model.body(name).mass, name
    for index in range(after.model.nu):
        name = after.model.actuator(index).name
        assert np.array_equal(after.model.actuator(name).gear, before.model.actuator(name).gear), name


def test_the_arm_is_measured_on_the_side_that_has_one():
    """WHO measures the left arm; the right one will do, and an infant without arms has no such number."""
    arms = {
        (): pytest.approx(14.03, abs=0.1),
        ("left_upper_arm",): pytest.approx(14.03, abs=0.1),
        ("left_upper_arm", "right_upper_arm"): None,
    }
    for remove, girth_cm in arms.items():
        assert mimoc.build(spec("mitten", remove)).manifest.child.arm_circumference_cm == girth_cm
