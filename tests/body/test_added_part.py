"""Parts from outside are one record: nothing else knows of them.

Three are: a tail, which hangs on the hip, a wing on each side of the chest, and paws in place of hands.
"""

from collections.abc import Iterator
from dataclasses import replace

import mujoco
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env
from support.registering import registered

import mimoc
from mimoc.anatomy.part import (
    BodyGeometry,
    GeomShape,
    PartKind,
    ReferenceGeom,
    ReferenceJoint,
    ReferenceMotor,
    ReferencePart,
)
from mimoc.anatomy.parts import PARTS
from mimoc.base.errors import KindError, SpecError
from mimoc.body.poses import CONTACT_DEPTH_M, POSES
from mimoc.bundle.model import load_model
from mimoc.compiler.explain import explain
from mimoc.schema.infant import read_spec
from mimoc.schema.source import parse

TAIL = ReferencePart(
    "tail",
    "hip",
    (
        ReferenceGeom(
            "tail1", "capsule", 0.05, ("hip_circumference",), "in proportion to hip_circumference", material="pants_up"
        ),
    ),
    (ReferenceJoint("robot:tail", (0, 1, 0), (-30, 30), 0.2, 0.05, 0.001, 0.001),),
    position_from=("hip_circumference",),
    rule="on the back of the pelvis",
    motors=(ReferenceMotor("act:tail", "robot:tail", 0.8, (-1, 1), 1.5, "tail1"),),
    skin_spacing_m=0.01,
    torque_site="torque_tail",
)
WING = ReferencePart(
    "{side}_wing",
    "chest",
    (ReferenceGeom("{side}_wing1", "box", 0.03, ("chest_circumference",), "in proportion to chest_circumference"),),
    (ReferenceJoint("robot:{side}_wing", (1, 0, 0), (-20, 40), 0.2, 0.05, 0.001, 0.001),),
    position_from=("chest_circumference",),
    rule="on the back of the chest",
    motors=(ReferenceMotor("act:{side}_wing", "robot:{side}_wing", 0.5, (-0.5, 1), 1.5, "{side}_wing1"),),
    group="{side}_arm",
    skin_spacing_m=0.02,
    torque_site="torque_{side}_wing",
)
SENSES = {"proprioception": {"include": ["velocity", "torque"]}, "vestibular": {}, "touch": {}}
SENSES["vision"] = {"width_px": 16, "height_px": 16}


def tail(p) -> BodyGeometry:
    hip = p.trunk.pelvis[0]
    return BodyGeometry(
        origins={"tail": (-1.1 * hip, 0.0, 0.0)},
        shapes={"tail1": GeomShape((0.2 * hip, 0.4 * hip), (0.0, 0.0, 0.5 * hip))},
    )


def wings(p) -> BodyGeometry:
    chest = p.trunk.girdle[0]
    return BodyGeometry(
        origins={"{side}_wing": (-1.3 * chest, -0.5 * chest, 0.0)},
        shapes={"{side}_wing1": GeomShape((0.1 * chest, 0.5 * chest, 0.7 * chest), (0.0, -0.5 * chest, 0.0))},
    )


def paws(p) -> BodyGeometry:
    half = p.hand.length_m / 4
    return BodyGeometry(
        origins={"{side}_hand": (0.0, 0.0, p.forearm.length_m)},
        shapes={"{side}_hand1": GeomShape((p.forearm.radius_m, half), (0.0, 0.0, half))},
    )


PAW = ReferencePart(
    "{side}_hand",
    "{side}_lower_arm",
    (ReferenceGeom("{side}_hand1", "capsule", 0.09, ("hand_length", "forearm_circumference"), "half of hand_length"),),
    (ReferenceJoint("robot:{side}_hand1", (0, 1, 0), (-40, 40), 0.2, 0.05, 0.001, 0.001),),
    position_from=("elbow_hand_length",),
    rule="at the wrist",
    motors=(ReferenceMotor("act:{side}_paw", "robot:{side}_hand1", 0.8, (-1, 1), 1.5, "{side}_hand1"),),
    group="{side}_hand",
    skin_spacing_m=0.01,
    torque_site="torque_{side}_wrist",
)
TAIL_KIND = PartKind("tail", "A short tail.", (TAIL,), tail)
KINDS = (
    TAIL_KIND,
    PartKind("wings", "Small wings.", (WING,), wings),
    PartKind("paw", "Paws with one joint.", (PAW,), paws, replaces="hands"),
)


@pytest.fixture(scope="module", autouse=True)
def added() -> Iterator[None]:
    with registered(*KINDS):
        yield


def spec(age_months=9, **keys):
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "senses": SENSES, "scene": {"kind": "flat"}}
    body = {"extra": ["tail", "wings"], **keys.pop("body", {})}
    return mimoc.InfantSpec.model_validate({**data, "body": body, **keys})


@pytest.fixture(scope="module")
def bundle(added) -> mimoc.Bundle:
    return mimoc.build(spec())


@pytest.fixture(scope="module")
def model(bundle) -> mujoco.MjModel:
    return load_model(bundle)


@pytest.mark.parametrize("actuation", ["torque", "muscle", "position"])
@pytest.mark.parametrize(("age_months", "hands", "target"), [(0, "mitten", None), (24, "five_finger", "mimo")])
def test_an_infant_of_any_age_has_it(age_months, hands, target, actuation):
    wanted = spec(age_months, body={"hands": hands}, actuation={"model": actuation})
    model = load_model(mimoc.build(wanted, target))
    moved = {model.joint(model.actuator(index).trnid[0]).name for index in range(model.nu)}
    assert {"robot:tail", "robot:left_wing", "robot:right_wing"} <= moved
    assert model.body(model.body("tail").parentid[0]).name == "hip"


def test_it_runs_with_every_sense(bundle, open_env):
    env = open_env(bundle=bundle)
    check_env(env, skip_render_check=True)
    observation, _ = env.reset(seed=0)
    assert {"proprioception", "vestibular", "touch"} < observation.keys()
    joints = env.layout("proprioception")
    assert {"robot:tail angle [rad]", "robot:left_wing velocity [rad/s]"} <= set(joints)
    assert {f"proprio:{part}.x torque [N m]" for part in ("tail", "left_wing", "right_wing")} <= set(joints)


def test_the_check_of_a_bundle_passes(bundle, tmp_path, invoke):
    assert invoke("check", mimoc.write_bundle(bundle, tmp_path / "infant")).code == 0


@pytest.mark.parametrize("pose", POSES)
def test_it_rests_on_the_ground_in_every_pose(model, pose):
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_forward(model, data)
    depths_m = [-contact.dist for contact in data.contact if 0 in model.geom_bodyid[contact.geom]]
    assert max(depths_m) == pytest.approx(CONTACT_DEPTH_M, abs=1e-8)


def test_it_has_skin_at_its_own_distance(bundle):
    skin = {part.body: part for part in bundle.manifest.senses.touch.skin}
    assert skin["tail"].points > 10
    assert skin["left_wing"].points == skin["right_wing"].points > 10
    only_arms = mimoc.build(spec(senses={"touch": {"regions": ["arms"]}})).manifest.senses.touch.skin
    bodies = {part.body for part in only_arms}
    assert {"left_wing", "right_wing"} < bodies
    assert "tail" not in bodies


def test_what_touches_it_is_felt_there(open_env):
    env = open_env(bundle=mimoc.build(spec(scene={"kind": "flat", "pose": "supine"})))
    env.reset(seed=0)
    for _ in range(20):
        env.step(np.zeros(env.action_space.shape, np.float32))
    assert np.abs(env.skin.forces[env.skin.bodies == "tail"]).max() > 0


def test_it_grows_with_what_it_follows():
    young, old = (load_model(mimoc.build(spec(age_months))) for age_months in (0, 24))
    assert np.all(young.geom("tail1").size[:2] < old.geom("tail1").size[:2])
    assert young.body("left_wing").mass < old.body("left_wing").mass
    assert young.actuator("act:tail").gear[0] < old.actuator("act:tail").gear[0]
    then = load_model(mimoc.build(spec(18)))
    assert then.actuator("act:tail").gear[0] == pytest.approx(0.8)
    assert then.body("tail").mass[0] == pytest.approx(0.05)


def test_it_belongs_to_a_group_of_muscles(bundle):
    groups = bundle.manifest.anatomy.groups
    assert "robot:tail" in groups["trunk"]
    assert "robot:left_wing" in groups["left_arm"]
    strong = load_model(mimoc.build(spec(actuation={"strength": {"trunk": 2, "left_arm": 0.5}})))
    usual = load_model(bundle)
    for motor, factor in {"act:tail": 2, "act:left_wing": 0.5, "act:right_wing": 1}.items():
        assert strong.actuator(motor).gear[0] == pytest.approx(factor * usual.actuator(motor).gear[0])


def test_it_can_be_held_and_is_locked_with_its_group():
    constraints = mimoc.build(spec(actuation={"locked": ["trunk"]}, scene={"held": ["tail"]})).manifest.constraints
    assert "robot:tail" in {lock.joint for lock in constraints.locks}
    assert "tail" in {weld.body for weld in constraints.welds}


def test_it_can_be_scaled(model):
    longer = load_model(mimoc.build(spec(body={"parts": {"tail": {"length": 1.2}, "left_wing": {"girth": 1.5}}})))
    assert longer.geom("tail1").size[1] == pytest.approx(1.2 * model.geom("tail1").size[1])
    assert longer.geom("tail1").size[0] == pytest.approx(model.geom("tail1").size[0])
    assert longer.geom("left_wing1").size[0] == pytest.approx(1.5 * model.geom("left_wing1").size[0])
    assert longer.geom("right_wing1").size == pytest.approx(model.geom("right_wing1").size)


def test_it_can_be_removed():
    removed = mimoc.build(spec(body={"remove": ["tail", "left_wing"]}))
    model = load_model(removed)
    names = {model.body(index).name for index in range(model.nbody)}
    assert names & {"tail", "left_wing", "right_wing"} == {"right_wing"}
    assert "tail" not in removed.files["scene.xml"].decode() + removed.files["infant.xml"].decode()


def test_its_numbers_are_explained(bundle):
    lines = explain(bundle, "geom.tail1.mass").lines
    assert any("of the average child of 18 months has 0.05 kg" in line for line in lines), lines
    assert any("hip_circumference" in line for line in explain(bundle, "geom.tail1.size").lines)
    assert explain(bundle, "skin.tail.spacing").lines
    assert explain(bundle, "actuator.act:left_wing.gear").lines


def test_left_mirrors_right_and_all_have_their_material(model):
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    left, right = (data.geom(f"{side}_wing1").xpos for side in ("left", "right"))
    assert left == pytest.approx(right * (1, -1, 1))
    assert model.joint("robot:left_wing").axis == pytest.approx(-model.joint("robot:right_wing").axis)
    materials = {geom: model.mat(model.geom(geom).matid[0]).name for geom in ("tail1", "left_wing1")}
    assert materials == {"tail1": "pants_up", "left_wing1": "skin"}


def test_the_spec_language_knows_its_name():
    text = "mimoc: 1\nname: x\nage_months: 9\nbody: {parts: {tial: {length: 1.2}}, remove: [left_win]}"
    with pytest.raises(SpecError) as error:
        read_spec(parse(text, "spec.yaml"))
    assert "did you mean 'tail'" in str(error.value)
    assert "did you mean 'left_wing'" in str(error.value)


def test_only_who_names_it_has_it(bundle):
    without = mimoc.build(spec(body={"extra": None}))
    assert "tail" not in without.files["infant.xml"].decode()
    assert without.manifest.plugins == {}
    assert bundle.manifest.plugins == {"parts.tail": "", "parts.wings": ""}
    assert explain(bundle, "plugins.parts.tail").lines
    notes = [note for note in bundle.manifest.notes if "tail" in note]
    assert notes, bundle.manifest.notes


def test_all_else_stays_as_it_is_but_for_its_place_in_lists(model):
    """Masses, shapes, joints and gears of a child with a tail and wings are those of one without."""
    usual = load_model(mimoc.build(spec(body={"extra": None})))
    for index in range(usual.nbody):
        name = usual.body(index).name
        assert usual.body(name).mass == model.body(name).mass, name
        assert usual.body(name).pos == pytest.approx(model.body(name).pos), name
    for index in range(usual.nu):
        name = usual.actuator(index).name
        assert usual.actuator(name).gear[0] == model.actuator(name).gear[0]
    for index in range(usual.njnt):
        name = usual.joint(index).name
        assert usual.joint(name).range == pytest.approx(model.joint(name).range)
        assert usual.joint(name).stiffness == model.joint(name).stiffness


def test_it_is_drawn_with_a_skin_over_the_rest():
    skinned = load_model(mimoc.build(spec(body={"skin": True})))
    assert skinned.nskin
    assert skinned.geom("tail1").group == skinned.geom("left_eye1").group != skinned.geom("lb").group


@pytest.mark.parametrize("age_months", [0, 9, 24])
def test_other_hands_take_the_place_of_mimos(age_months, open_env):
    env = open_env(bundle=mimoc.build(spec(age_months, body={"hands": "paw", "extra": None})))
    model = env.unwrapped.model
    motors = {model.actuator(index).name for index in range(model.nu)}
    assert motors > {"act:left_paw", "act:right_paw", "act:left_toes"}
    assert "left_fingers" not in {model.body(index).name for index in range(model.nbody)}
    assert any("right_hand1 angle" in name for name in env.layout("proprioception"))
    assert {part.body for part in env.bundle.manifest.senses.touch.skin} > {"left_hand", "right_hand"}
    env.reset(seed=0)
    env.step(np.zeros(env.action_space.shape, np.float32))


def test_a_task_that_needs_fingers_says_so_of_paws():
    with pytest.raises(SpecError, match=r"fingers"):
        mimoc.build(spec(body={"hands": "paw"}, task={"kind": "standup"}))


def test_paws_have_no_skin_of_mimocs():
    assert not load_model(mimoc.build(spec(body={"hands": "paw"}))).nskin
    with pytest.raises(SpecError, match=r"body\.skin: there is no skin for 'paw' hands; leave this out"):
        mimoc.build(mimoc.InfantSpec(mimoc=1, name="x", age_months=9).with_(body={"hands": "paw", "skin": True}))


def test_editors_and_errors_know_what_can_be_chosen():
    body = mimoc.InfantSpec.model_json_schema()["$defs"]["BodySpec"]["properties"]
    assert body["hands"]["enum"] == ["mitten", "five_finger", "paw"]
    assert "wings" in str(body["extra"])
    for keys, advice in {
        "hands: pow": "body.hands: 'pow' is not a choice; did you mean 'paw'",
        "extra: [tali]": "'tali' is not a choice; did you mean 'tail'",
        "remove: [tail]": "'tail' belongs to 'tail'; add 'extra: [tail]' to the body, or leave this out",
    }.items():
        with pytest.raises(SpecError) as error:
            read_spec(parse(f"mimoc: 1\nname: x\nage_months: 9\nbody: {{{keys}}}", "spec.yaml"))
        assert advice in str(error.value)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (replace(TAIL, parent="hips"), "'tail' is on 'hips'; did you mean 'hip'"),
        (replace(TAIL, parent="{side}_foot"), "'tail' is on a part of both sides; write '{side}' into its name"),
        (replace(TAIL, geoms=()), "'tail' has no geom"),
        (replace(TAIL, name="hip"), "the name 'hip' is taken"),
        (replace(WING, name="{side}_fin"), "the name '{side}_wing1' is taken"),
        (replace(TAIL, group="{side}_leg"), "matures with 'leg'; choose from ankle, arm, eyes, hand, hip, knee"),
        (replace(TAIL, joints=()), "the motor 'act:tail' moves 'robot:tail'"),
        (replace(TAIL, name="{side}_tail"), "write '{side}' into both names, or neither"),
    ],
)
def test_parts_that_do_not_fit_are_refused(wrong, message):
    with pytest.raises(KindError) as error:
        mimoc.register(PartKind("tail", "Another tail.", (wrong,), tail))
    assert message in str(error.value)
    assert PARTS["tail"] is TAIL_KIND


def test_other_hands_that_are_not_on_the_forearm_are_refused():
    with pytest.raises(KindError, match=r"hands begin with '{side}_hand', which is on '{side}_lower_arm'"):
        mimoc.register(PartKind("tails", "Tails.", (TAIL,), tail, replaces="hands"))


def test_a_shape_that_says_too_little_is_an_error_of_one_line():
    part = ReferencePart("stump", "hip", (ReferenceGeom("stump1", "sphere", 0.1, (), "none"),), skin_spacing_m=0.01)
    message = r"the shape of the body part 'stump' does not say size and place of the geom 'stump1'"
    stump = PartKind("stump", "A stump.", (part,), lambda _: BodyGeometry())
    with registered(stump), pytest.raises(KindError, match=message):
        mimoc.build(spec(body={"extra": ["stump"]}))


def test_a_part_on_other_hands_than_the_infant_has_is_an_error():
    geom = ReferenceGeom("{side}_claw1", "sphere", 0.01, ("hand_length",), "as large as a claw")
    part = ReferencePart("{side}_claw", "{side}_fingers", (geom,), skin_spacing_m=0.01)
    shape = BodyGeometry({"{side}_claw": (0.0, 0.0, 0.01)}, {"{side}_claw1": GeomShape((0.003,), (0.0, 0.0, 0.0))})
    with registered(PartKind("claws", "Claws.", (part,), lambda _: shape)):
        assert "left_claw" in mimoc.build(spec(body={"extra": ["claws"]})).files["infant.xml"].decode()
        with pytest.raises(
            KindError, match=r"is on '{side}_fingers', which a body with five_finger hands does not have"
        ):
            mimoc.build(spec(body={"extra": ["claws"], "hands": "five_finger"}))
