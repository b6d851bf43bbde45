"""What a spec changes of a single body: measurements of both sides or of one, and parts by factors."""

import math
import random

import mujoco
import numpy as np
import pytest
from hypothesis import assume, given, settings, strategies as st
from support.full import full_but

import mimoc
from mimoc.anatomy.anatomy import assemble
from mimoc.base.geometry.primitives import ellipse_perimeter, volume
from mimoc.body.grow import grow_body, grow_child, reference_of
from mimoc.bundle.model import load_model
from mimoc.compiler.measuring import MEASURES, STRAIGHT, Figure
from mimoc.fits import measure
from mimoc.schema import InfantSpec
from mimoc.schema.names import LIMB_MEASUREMENTS, MEASUREMENTS, limb_bodies, trunk_bodies

HANDS = ("mitten", "five_finger")
UP, FORWARD, LEFT = np.eye(3)[[2, 0, 1]]
INERT = {  # What no part of a body follows: each kind of hand has its own measurements.
    "mitten": {"rump_sole_length", "middle_finger_diameter", "thumb_diameter"},
    "five_finger": {"rump_sole_length", "maximum_fist_breadth"},
}
HEAD_SHAPE = {"head_breadth", "head_length"}  # What shares out the head's circumference.


def spec(hands: str = "mitten", age_months: float = 9, **body) -> InfantSpec:
    data = {"mimoc": 1, "name": "x", "age_months": age_months, "body": {"hands": hands, **body}}
    return InfantSpec.model_validate(data)


def tree_of(infant: InfantSpec):
    return grow_body(infant).tree


NEARLY = {
    "hip_breadth": 0.03,
    "hip_circumference": 0.02,
    "knee_sole_length": 0.03,
    "rump_knee_length": 0.03,
    "shoulder_breadth": 0.07,
    "elbow_hand_length": 1e-4,
    "hand_breadth": 1e-3,
    "hand_length": 1e-3,
}
"""How far the body is from measurements that share their solids: thighs make hips broader, arms must clear the chest,
and knees take their place between two lengths. Palms are rounded."""


FOLLOWED = [(hands, name) for hands in HANDS for name in MEASUREMENTS if name not in INERT[hands] | HEAD_SHAPE]


@pytest.mark.parametrize("factor", full_but([1.05], [0.96]))
@pytest.mark.parametrize(("hands", "name"), FOLLOWED)
def test_a_measurement_is_found_on_the_compiled_body(infant_with, hands, name, factor):
    value_m = measure(9)[name] * factor
    figure = Figure(infant_with(hands=hands, measurements={f"{name}_cm": 100 * value_m}).model)
    take, _ = MEASURES[name]
    for side in ("left", "right"):
        found_m = take(figure.pose(STRAIGHT), side)
        assert found_m == pytest.approx(value_m, rel=NEARLY.get(name, 2e-5), abs=1e-9), side


@pytest.mark.parametrize("name", sorted(HEAD_SHAPE))
def test_a_longer_or_broader_head_has_the_same_circumference(infant_with, infant_at, name):
    child = {**measure(9), name: 1.05 * measure(9)[name]}
    before = infant_at(9).model.geom("head").size
    after = infant_with(measurements={f"{name}_cm": 100 * child[name]}).model.geom("head").size
    assert after[0] / after[1] == pytest.approx(child["head_length"] / child["head_breadth"], rel=1e-6)
    assert ellipse_perimeter(*after[:2]) == pytest.approx(ellipse_perimeter(*before[:2]), rel=1e-6)
    assert after[2] == before[2]


def followers(infant: InfantSpec, name: str, side: str = "") -> tuple[set[str], set[str]]:
    """Return the geoms and the bodies that say they follow a measurement, of one side or of all."""
    geoms, bodies = set(), set()
    for here, part in assemble(infant.body.hands, infant.body.chest_joint).parts:
        if side in ("", here):
            bodies |= {part.name.format(side=here)} if name in part.position_from else set()
            follow = [geom.name for geom in part.geoms if name in (*geom.size_from, *geom.position_from)]
            geoms |= {geom.format(side=here) for geom in follow}
    return geoms, bodies


def figures(geom) -> tuple[float, ...]:
    return (*geom.size_m, *geom.pos_m)


def differences(before, after) -> tuple[set[str], set[str]]:
    pairs = ((name, figures(geom), figures(after.geoms[name])) for name, geom in before.geoms.items())
    geoms = {name for name, first, second in pairs if not np.allclose(first, second, rtol=0, atol=1e-12)}
    pairs = zip(before.bodies, after.bodies, strict=True)
    return geoms, {body.name for body, other in pairs if body.pos_m != other.pos_m}


@pytest.mark.parametrize("side", ["", "left", "right"])
@pytest.mark.parametrize("hands", HANDS)
def test_what_changes_is_what_says_that_it_follows(hands, side):
    before = tree_of(spec(hands))
    for name in LIMB_MEASUREMENTS if side else MEASUREMENTS:
        key = "_".join(filter(None, (side, name, "cm")))
        changed = spec(hands, measurements={key: 103 * measure(9)[name]})
        geoms, bodies = differences(before, tree_of(changed))
        follow = followers(changed, name, side)
        assert geoms <= follow[0], name
        assert bodies <= follow[1], name
        assert bool(geoms) == (name not in INERT[hands]), name


@pytest.mark.parametrize("hands", HANDS)
def test_what_says_that_it_follows_a_measurement_does(hands):
    """Tried with children whose age gives them another one, since an override of thigh leaves the shank alone."""
    average, reference = measure(9), reference_of(spec(hands))
    before = grow_child(spec(hands), average, reference).tree
    for name in MEASUREMENTS:
        after = grow_child(spec(hands), average.scaled({name: 1.03}, "", ()), reference).tree
        assert followers(spec(hands), name)[0] == differences(before, after)[0], name


@pytest.mark.parametrize(("hands", "name"), [pair for pair in FOLLOWED if pair[1] in LIMB_MEASUREMENTS])
def test_both_sides_one_by_one_are_both_sides_at_once(hands, name):
    value_cm = 102 * measure(9)[name]
    together = tree_of(spec(hands, measurements={f"{name}_cm": value_cm}))
    apart = {f"{side}_{name}_cm": value_cm for side in ("left", "right")}
    assert tree_of(spec(hands, measurements=apart)) == together
    overruled = {f"{name}_cm": 1.01 * value_cm, **apart}
    assert tree_of(spec(hands, measurements=overruled)) == together, "the one side says more than both"


def lengthened(name: str) -> int:
    """Return the axis that a part's length runs along in its own frame."""
    return 0 if name.split("_", 1)[-1] in ("foot", "toes", "big_toe") else 2


@pytest.mark.parametrize("hands", HANDS)
def test_a_part_is_scaled_along_and_across_with_all_that_is_attached(hands):
    before = tree_of(spec(hands))
    length, thickness = 1.1, 1.04
    for part in before.bodies:
        scaled = spec(hands, parts={part.name: {"length": length, "girth": thickness}})
        try:
            after = tree_of(scaled)
        except mimoc.MimocError:
            pytest.fail(f"{part.name} cannot be scaled")
        factors = np.full(3, thickness)
        factors[lengthened(part.name)] = length
        for body, other in zip(before.bodies, after.bodies, strict=True):
            mine, above = body.name == part.name, body.parent == part.name
            assert other.pos_m == pytest.approx(np.multiply(body.pos_m, factors if above else 1), rel=1e-12)
            for joint, moved in zip(body.joints, other.joints, strict=True):
                assert moved.anchor_m == pytest.approx(np.multiply(joint.anchor_m, factors if mine else 1), rel=1e-12)
            for geom, sized in zip(body.geoms, other.geoms, strict=True):
                assert sized.pos_m == pytest.approx(np.multiply(geom.pos_m, factors if mine else 1), rel=1e-12)
                growth = volume(sized.type, sized.size_m) / volume(geom.type, geom.size_m)
                about = 0.03 if mine else 1e-12  # Masses follow MIMo's solids, whose caps have other shares of them.
                assert sized.mass_kg == pytest.approx(geom.mass_kg * growth, rel=about)
                assert (growth != 1) == mine, geom.name
                for motor, stronger in zip(before.motors, after.motors, strict=True):
                    if motor.driven_geom == geom.name:
                        assert (stronger.gear_nm > motor.gear_nm) == mine


@pytest.mark.full
@given(
    st.floats(0, 24),
    st.fixed_dictionaries(
        {
            name: st.fixed_dictionaries({"length": st.floats(0.5, 2), "girth": st.floats(0.5, 2)})
            for name in ("upper_body", "chest", "left_upper_arm")
        }
    ),
    st.sampled_from(["maturing", "published"]),
)
@settings(max_examples=15)
def test_arms_are_not_in_the_upper_body_whatever_is_scaled(age_months, parts, development):
    """At rest: contacts would fling them out. They are as far in as half of their radius at most."""
    try:
        model = load_model(mimoc.build(spec(age_months=age_months, parts=parts).with_(development=development)))
    except mimoc.MimocError:
        assume(False)
        raise
    data = mujoco.MjData(model)
    data.qpos[3] = 1
    mujoco.mj_kinematics(model, data)
    for side in ("left", "right"):
        arm = model.geom(f"{side}_uarm1")
        gap_m = mujoco.mj_geomDistance(model, data, model.geom("ub2").id, arm.id, 1, None)
        assert gap_m > -0.5 * arm.size[0] - 1e-6


def test_a_box_and_a_rod_are_scaled_as_their_part_lies():
    """A foot lies along x, a thigh hangs along z, and a hand's rim lies across it."""
    parts = {name: {"length": 1.1, "girth": 0.95} for name in ("left_foot", "left_upper_leg", "left_hand")}
    before, after = (tree_of(infant).geoms for infant in (spec(), spec(parts=parts)))

    def grown(geom: str) -> list[float]:
        pairs = zip(before[geom].size_m, after[geom].size_m, strict=True)
        return pytest.approx([new / old for old, new in pairs], rel=1e-9)

    assert grown("left_foot2") == [1.1, 0.95, 0.95]
    assert grown("left_upper_leg1") == [0.95, 1.1]
    assert grown("left_hand2") == [math.sqrt(0.95 * 1.1), 0.95]
    assert grown("right_foot2") == [1, 1, 1]


def test_what_sits_on_a_scaled_part_follows(infant_with, infant_at):
    factor = 1.1
    parts = {
        "head": {"length": factor, "girth": factor},
        "left_foot": {"length": factor},
        "left_eye": {"length": factor, "girth": factor},
    }
    before, after = infant_at(9), infant_with(parts=parts)

    def local(infant, kind: str, name: str) -> np.ndarray:
        return getattr(infant.model, kind)(name).pos

    for kind, name in [
        ("site", "BODY_25:Nose"),
        ("site", "BODY_25:LEar"),
        ("site", "vestibular"),
        ("geom", "nose"),
        ("geom", "left_ear"),
        ("body", "left_eye"),
        ("camera", "eye_left"),
    ]:
        assert local(after, kind, name) == pytest.approx(factor * local(before, kind, name), rel=1e-6), name
    assert local(after, "camera", "eye_right") == pytest.approx(local(before, "camera", "eye_right"))
    heel = [local(infant, "site", "BODY_25:LHeel")[0] for infant in (before, after)]
    assert heel[1] == pytest.approx(factor * heel[0])
    assert after.span_m(UP, after.limb("hip"))[0] == pytest.approx(0, abs=1e-8)


@pytest.mark.parametrize("hands", HANDS)
def test_a_one_sided_change_leaves_the_other_side_alone(hands):
    changes = {
        "measurements": {"left_foot_length_cm": 11.5, "left_upper_arm_circumference_cm": 15, "left_hand_length_cm": 9},
        "parts": {"left_lower_leg": {"girth": 1.1, "length": 0.97}},
    }
    before, after = tree_of(spec(hands)), tree_of(spec(hands, **changes))
    for body, other in zip(before.bodies, after.bodies, strict=True):
        assert (body == other) == ("left" not in body.name) or body.name in ("left_eye",), body.name


@pytest.mark.parametrize("hands", HANDS)
def test_both_sides_of_a_symmetric_change_stay_mirror_images(hands):
    parts = {
        f"{side}_{limb}": {"length": 1.05, "girth": 0.9} for side in ("left", "right") for limb in ("hand", "foot")
    }
    for body in (tree := tree_of(spec(hands, parts=parts))).bodies:
        if body.name.startswith("left"):
            other = next(twin for twin in tree.bodies if twin.name == body.name.replace("left", "right"))
            assert [geom.size_m for geom in body.geoms] == [geom.size_m for geom in other.geoms]
            assert body.pos_m == tuple(np.multiply(other.pos_m, (1, -1, 1)))


CHANGED = {
    "individual": {"sex": "female", "length_percentile": 20, "weight_kg": 8},
    "measurements": {"foot_length_cm": 11.2, "left_forearm_circumference_cm": 13.0, "head_circumference_cm": 44},
    "parts": {
        "right_upper_arm": {"length": 0.95, "girth": 1.05},
        "left_foot": {"length": 1.1},
        "head": {"girth": 1.02},
    },
    "remove": ["left_hand", "right_toes"],
    "expression": "happy",
}


@pytest.mark.parametrize("hands", HANDS)
def test_one_infant_leaves_nothing_behind_for_the_next(hands):
    one, other = spec(hands, **CHANGED), spec(hands)
    first, between_them, again, plain = (mimoc.build(infant).files for infant in (one, other, one, other))
    assert first == again
    assert between_them == plain
    assert first["infant.xml"] != plain["infant.xml"]


@settings(max_examples=10)
@given(seed=st.integers(0, 1000))
def test_the_order_of_keys_does_not_matter(seed):
    chance = random.Random(seed)

    def shuffled(data):
        if isinstance(data, list):
            return chance.sample(data, len(data))
        if isinstance(data, dict):
            return {key: shuffled(data[key]) for key in chance.sample(sorted(data), len(data))}
        return data

    assert tree_of(spec(**shuffled(CHANGED))) == tree_of(spec(**CHANGED))


@settings(max_examples=20)
@given(data=st.data(), hands=st.sampled_from(HANDS), age_months=st.floats(0, 24))
def test_any_mild_change_builds_and_mujoco_takes_it(data, hands, age_months, infant_with):
    keys = [name for name in MEASUREMENTS if name not in INERT[hands]]
    average = measure(age_months)
    changed = data.draw(st.dictionaries(st.sampled_from(keys), st.floats(0.92, 1.08), max_size=4))
    factor = st.floats(0.85, 1.15)
    scale = st.fixed_dictionaries({}, optional={"length": factor, "girth": factor})
    parts = data.draw(st.dictionaries(st.sampled_from(trunk_bodies() + limb_bodies(hands)), scale, max_size=4))
    values_cm = {f"{name}_cm": 100 * average[name] * factor for name, factor in changed.items()}
    infant = infant_with(age_months, hands=hands, measurements=values_cm, parts=parts)
    assert infant.model.nu == {"mitten": 44, "five_finger": 88}[hands]
    mujoco.mj_step(infant.model, infant.data, nstep=20)
    assert np.all(np.isfinite(infant.data.qpos))
