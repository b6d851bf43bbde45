"""Impaired signals: delays to one arm, noise of one hand, an eye that sees less, a field that ends."""

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from hypothesis import given, strategies as st
from pydantic import ValidationError

import mimoc
from mimoc.base.errors import BundleError
from mimoc.bundle.manifest import Manifest
from mimoc.bundle.model import check_model, load_model
from mimoc.components.senses.vision.foveation import visual_field
from mimoc.runtime.delays import Timing, within
from mimoc.schema.senses import DelayEntry, PartDelay

BASE = {"mimoc": 1, "name": "kim", "age_months": 9, "senses": {"proprioception": {}}}


def manifest(delays=None, **impairments):
    data = {**BASE, "delays": {"preset": "physiological", **(delays or {})}, "impairments": impairments}
    return mimoc.build(mimoc.InfantSpec.model_validate(data)).manifest


def parts(delay: DelayEntry) -> dict[str, float]:
    return {part.body: part.ms for part in delay.parts}


def test_delays_are_longer_to_and_from_the_parts_that_are_named():
    usual = manifest().delays.motor
    late = manifest(delay={"right_arm": 2, "right_hand": 3, "body": 1.2}).delays.motor
    assert late.ms == round(1.2 * usual.ms / 5) * 5
    assert late.legs_ms == round(1.2 * usual.legs_ms / 5) * 5
    assert parts(late) == {"right_upper_arm": 2 * usual.ms, "right_hand": 3 * usual.ms}


def test_a_leg_is_later_by_its_own_usual_delay():
    usual, late = manifest().delays.motor, manifest(delay={"left_leg": 2}).delays.motor
    assert parts(late) == {"left_upper_leg": 2 * usual.legs_ms}
    assert (late.ms, late.legs_ms) == (usual.ms, usual.legs_ms)


TREE = """<mujoco><worldbody><body name="trunk"><geom size="1"/>
<body name="arm"><geom size="1"/><body name="hand"><geom size="1"/></body></body>
<body name="leg"><geom size="1"/></body></body></worldbody></mujoco>"""


@given(st.integers(0, 9), st.integers(0, 9), st.integers(0, 9), st.integers(0, 9))
def test_each_number_has_the_delay_of_the_innermost_part(trunk, arm, hand, leg):
    """Numbers of trunk, arm, hand and leg are of one group each, and all are of some."""
    model = mujoco.MjModel.from_xml_string(TREE)
    bodies = np.array([model.body(name).id for name in ("trunk", "arm", "hand", "leg", "hand")])
    entry = DelayEntry(ms=trunk, legs_ms=leg, parts=(PartDelay(body="arm", ms=arm), PartDelay(body="hand", ms=hand)))
    groups = Timing(10, 1, {"touch": entry}, ("leg",)).groups("touch", within(model, bodies))
    steps = np.full(len(bodies), -1)
    for _, late, part in groups:
        assert (steps[part] == -1).all()
        steps[part] = late
    assert steps.tolist() == [trunk, arm, hand, leg, hand]


def test_parts_without_numbers_leave_all_of_them_with_the_usual_delay():
    """As of an infant whose commanded actuators are none of the legs'."""
    model = mujoco.MjModel.from_xml_string(TREE)
    only_arms = np.array([model.body(name).id for name in ("arm", "hand")])
    timing = Timing(10, 1, {"touch": DelayEntry(ms=3, legs_ms=5)}, ("leg",))
    assert timing.groups("touch", within(model, only_arms)) == [("touch", 3, None)]


def test_a_command_to_a_late_arm_arrives_later():
    def first_move(**keys) -> dict[str, int]:
        spec = mimoc.InfantSpec.model_validate({**BASE, "scene": {"kind": "empty"}, "delays": {"motor_ms": 20}, **keys})
        env = mimoc.make(spec)
        env.reset(seed=0)
        names, arrived = [actuator.name for actuator in env.unwrapped.manifest.actuation.actuators], {}
        for step in range(1, 9):
            env.step(np.ones(env.action_space.shape, np.float32))
            for side in ("left", "right"):
                act = env.unwrapped.data.ctrl[names.index(f"act:{side}_elbow")]
                if act and side not in arrived:
                    arrived[side] = step
        return arrived

    usual, late = first_move(), first_move(impairments={"delay": {"right_arm": 2.5}})
    assert usual["left"] == usual["right"] == late["left"]
    assert late["right"] == usual["right"] + 3


def test_only_commands_to_a_noisy_hand_are_disturbed():
    spec = mimoc.InfantSpec.model_validate({**BASE, "impairments": {"noise": {"right_hand": 0.3}}})
    env = mimoc.make(spec)
    env.reset(seed=0)
    env.step(np.full(env.action_space.shape, 0.5, np.float32))
    controls = dict(
        zip((a.name for a in env.unwrapped.manifest.actuation.actuators), env.unwrapped.data.ctrl, strict=False)
    )
    assert {name for name, value in controls.items() if value != 0.5} == {
        "act:right_wrist_rotation", "act:right_wrist_flexion", "act:right_wrist_ulnar", "act:right_fingers",
    }  # fmt: skip


@given(st.floats(1, 29), st.floats(1, 29))
def test_a_field_ends_where_it_is_said_to(left_deg, up_deg):
    field = visual_field(64, 64, 60.0, {"left": left_deg, "up": up_deg})
    across = np.degrees(np.arctan((np.arange(64) + 0.5 - 32) / 32 * np.tan(np.radians(30))))
    assert (field.any(axis=0) == (across >= -left_deg)).all()
    assert (field.any(axis=1) == (across >= -up_deg)).all()


def test_nothing_is_lost_of_a_field_that_is_not_named():
    assert visual_field(8, 4, 60.0, {}).all()
    assert not visual_field(8, 4, 60.0, {"left": 0, "right": 0}).any()


def test_one_eye_sees_less_and_both_lose_a_side():
    keys = {**BASE, "senses": {"vision": {"width_px": 32, "height_px": 32}}, "scene": {"kind": "room", "seed": 3}}
    spec = mimoc.InfantSpec.model_validate(
        {**keys, "impairments": {"acuity": {"left_eye": 0.2}, "field_deg": {"right": 0}}}
    )
    impaired, usual = mimoc.make(spec), mimoc.make(mimoc.InfantSpec.model_validate(keys))
    seen, before = impaired.reset(seed=0)[0], usual.reset(seed=0)[0]
    for eye in ("eye_left", "eye_right"):
        assert (seen[eye][:, 16:] == 0).all()
    assert (seen["eye_right"][:, :16] == before["eye_right"][:, :16]).all()
    cpd = 0.2 * usual.unwrapped.manifest.senses.vision.acuity_cpd
    keys["senses"] = {"vision": {"width_px": 32, "height_px": 32, "acuity": {"cpd": round(cpd, 9)}}}
    blurred = mimoc.make(mimoc.InfantSpec.model_validate(keys))
    expected = blurred.reset(seed=0)[0]["eye_left"].astype(int)
    assert (np.abs(seen["eye_left"][:, :16] - expected[:, :16]) <= 1).all()
    assert (expected != before["eye_left"]).mean() > 0.2
    blurred.close()
    impaired.close()
    usual.close()


@pytest.mark.parametrize(
    ("section", "change"),
    [
        (("noise",), {"of_commands": (0.1,)}),
        (("senses", "vision"), {"acuity_shares": (0.5,)}),
        (("senses", "vision"), {"field_deg": {"left": 100.0}}),
        (("delays", "motor"), {"parts": ({"body": "right_hand", "ms": 3.0},)}),
    ],
)
def test_a_manifest_that_says_too_little_or_too_much_is_refused(section, change):
    data = mimoc.build(mimoc.InfantSpec.model_validate({**BASE, "senses": {"vision": {}}})).manifest.model_dump()
    inner = data
    for name in section:
        inner = inner[name]
    inner.update(change)
    with pytest.raises(ValidationError):
        Manifest.model_validate(data)


def test_a_delay_of_a_body_that_is_not_there_is_refused(tmp_path):
    spec = mimoc.InfantSpec.model_validate(
        {**BASE, "delays": {"motor_ms": 20}, "impairments": {"delay": {"right_hand": 2}}}
    )
    bundle = mimoc.build(spec)
    parts = (PartDelay(body="third_hand", ms=20.0),)
    delays = bundle.manifest.delays.model_copy(update={"motor": DelayEntry(ms=20, parts=parts)})
    other = replace(bundle, manifest=bundle.manifest.model_copy(update={"delays": delays}), path=tmp_path)
    with pytest.raises(BundleError, match="third_hand"):
        check_model(other, load_model(bundle))
