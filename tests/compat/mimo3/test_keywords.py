"""What MIMo3's keywords are in a spec, and what is said of those that are nothing there."""

import mujoco
import numpy as np
import pytest

from mimoc.base.errors import MimocError
from mimoc.compat.mimo3 import (
    BENCHMARK_XML,
    BENCHMARK_XML_V2,
    DEFAULT_TOUCH_PARAMS,
    DEFAULT_VISION_PARAMS,
    MIMoEnv,
    PositionalModel,
)
from mimoc.compat.mimo3.keywords import Keywords, spec_of
from mimoc.compiler.child import child_of
from mimoc.schema import InfantSpec

PLAIN = Keywords(BENCHMARK_XML)
EYE = {"width": 64, "height": 48, "fovy": 50, "acuity": True, "foveation": True}


def spec(model_path=BENCHMARK_XML, **keywords):
    return spec_of(Keywords(model_path, **keywords))


def test_no_age_is_the_body_of_18_months():
    reference = spec()
    assert (reference.age_months, reference.development, reference.body.chest_joint) == (18, "published", True)
    assert spec(age=4.5).age_months == 4.5
    assert spec(BENCHMARK_XML_V2).body.hands == "five_finger"


def test_a_delay_of_n_is_n_control_steps():
    delays = spec(frame_skip=3, sensory_delay=2, motor_delay=4).delays
    assert (delays.sensory_ms, delays.motor_ms) == (30, 60)
    assert spec().delays == InfantSpec(mimoc=1, name="x", age_months=1).delays


def test_senses_that_are_not_asked_for_are_off():
    senses = spec().senses
    assert senses.proprioception.include == ()
    assert (senses.touch, senses.vision, senses.vestibular) == (None, None, None)


def test_skin_points_are_as_far_apart_as_the_scales_say():
    touch = spec(touch_params={"scales": {"left_hand": 0.007}, "response_function": "nearest"}).senses.touch
    assert (dict(touch.spacing_cm), touch.response) == ({"left_hand": 0.7}, "nearest")
    assert dict(spec(touch_params=DEFAULT_TOUCH_PARAMS).senses.touch.spacing_cm)["right_fingers"] == 0.2


def test_both_eyes_see_alike_by_equation_2_of_the_paper_unless_the_law_of_mimo3_is_asked_for():
    vision = spec(vision_params={"eye_left": EYE, "eye_right": EYE}).senses.vision
    assert (vision.width_px, vision.height_px, vision.fovy_deg) == (64, 48, 50)
    assert (vision.acuity, vision.foveation, vision.contrast) == ("age", 10, "linear")
    other = spec(vision_params={"eye_left": {**EYE, "acuity": 4, "contrast": "mimo3"}}).senses.vision
    assert (other.acuity, other.acuity_profile, other.contrast) == (4, "mimo_v2", "mimo3")
    assert spec(vision_params=DEFAULT_VISION_PARAMS).senses.vision.acuity == "off"


def test_a_measurement_is_in_cm():
    measured = spec(custom_measurements={"hand_length_cm": 9.5, "foot_length": 12, "thumb_diameter_mm": 11}).body
    assert dict(measured.measurements) == {"hand_length_cm": 9.5, "foot_length_cm": 12, "thumb_diameter_cm": 1.1}


def test_a_size_of_a_geom_is_that_of_both_sides_and_what_hangs_on_it_follows():
    sizes = {("left_larm", 1): 0.05, ("left_larm", 0): 0.021, ("geom:left_upper_leg1", 1): 0.06}
    infant, usual = (child_of(spec(age=9, custom_measurements=custom)).tree for custom in (sizes, {}))
    found = {geom.name: geom.size_m for body in infant.bodies for geom in body.geoms}
    for side in ("left", "right"):
        assert found[f"{side}_larm"][:2] == pytest.approx((0.021, 0.05), abs=1e-9)
        assert found[f"{side}_upper_leg1"][1] == pytest.approx(0.06, abs=1e-9)
    hands = [next(body.pos_m[2] for body in tree.bodies if body.name == "left_hand") for tree in (infant, usual)]
    assert hands[0] > hands[1] + 0.001


def test_a_spec_of_the_users_keeps_what_keywords_do_not_say():
    mine = InfantSpec(mimoc=1, name="kim", age_months=6, senses={"vestibular": {}}, actuation={"model": "muscle"})
    changed = spec(mine, age=8)
    assert (changed.age_months, changed.development, changed.actuation.model) == (8, "maturing", "muscle")
    assert changed.senses.vestibular is not None


@pytest.mark.parametrize(
    ("keywords", "advice"),
    [
        ({"model_path": "my/scene.xml"}, "mimoc import mimo scene.xml -o scene.yaml"),
        ({"sensory_delay": 0.5}, "whole number of steps"),
        ({"frame_skip": 0}, "1 or more"),
        ({"proprio_params": {"threshold": 0.1}}, "leave out 'threshold'"),
        ({"proprio_params": {"components": ["speed"]}}, "choose"),
        ({"touch_params": {"touch_function": "slip"}}, "choose from force_vector"),
        ({"touch_params": {"scales": {"left_ffdistal": 0.01}}}, "no 'left_ffdistal'"),
        ({"vision_params": {"eye_left": EYE, "eye_right": {**EYE, "width": 32}}}, "the same parameters"),
        ({"vision_params": {"eye": EYE}}, "choose from eye_left, eye_right"),
        ({"vision_params": {"eye_left": {**EYE, "acuty": 1}}}, "did you mean 'acuity'"),
        ({"vestibular_params": {"sensors": ["gyro"]}}, "vestibular_gyro"),
        ({"custom_measurements": {("head", 0): 0.07}}, "is not translated; give a measurement in cm"),
        ({"custom_measurements": {"hand_size": 7}}, "did you mean 'hand_length_cm'"),
        ({"age": 30}, "give 0 to 24 months"),
    ],
)
def test_what_has_no_counterpart_is_one_error_that_says_what_to_do(keywords, advice):
    with pytest.raises(MimocError, match=advice):
        spec(**keywords)


def test_motor_and_sensory_delays_take_effect():
    """MIMo3 raises an error with sensory delays, and delays motors by a step less."""
    plain, late = MIMoEnv(), MIMoEnv(motor_delay=2)
    push = np.ones(46)
    for env in (plain, late):
        env.reset(seed=0)
    for _ in range(2):
        late.step(push)
        assert not late.data.ctrl.any()
    late.step(push)
    assert late.data.ctrl.all()
    seen = MIMoEnv(sensory_delay=3)
    before = seen.reset(seed=0)[0]["observation"]
    observed = [seen.step(push)[0]["observation"] for _ in range(4)]
    assert all(np.array_equal(before, each) for each in observed[:3])
    assert not np.array_equal(before, observed[3])


def test_positions_are_commanded_by_angles():
    env = MIMoEnv(actuation_model=PositionalModel, proprio_params={"components": ["actuation", "velocity"]})
    observation, _ = env.reset(seed=0)
    assert observation["observation"].shape == (46 + 49 + 49,)
    assert np.array_equal(observation["observation"][-49:], env.proprioception.sensor_outputs["qvel"])
    assert env.proprioception.sensor_outputs["qvel"] == pytest.approx(np.zeros(49))
    joints = env.model.actuator_trnid[:, 0]
    assert env.action_space.high == pytest.approx(env.model.jnt_range[joints, 1])
    env.step(env.model.jnt_range[joints, 1])
    assert env.data.ctrl == pytest.approx(np.ones(46), abs=1e-6)
    assert len(env.actuation_model.observations()) == 46


def test_muscles_towards_negative_angles_come_first():
    env = MIMoEnv(actuation_model="MuscleModel", proprio_params={"components": ["actuation"]})
    env.reset(seed=0)
    env.step(np.repeat([1.0, 0.0], 46))
    names = [mujoco.mj_id2name(env.model, mujoco.mjtObj.mjOBJ_ACTUATOR, index) for index in range(env.model.nu)]
    assert [name.endswith("_negative") for name in names] == env.data.ctrl.astype(bool).tolist()
    activations = env.actuation_model.observations()[:92]
    assert activations[:46].min() > activations[46:].max()
