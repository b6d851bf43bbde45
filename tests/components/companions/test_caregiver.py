"""A caregiver acts when its script says, moves as adults do, and never through the infant."""

import copy
import re
from contextlib import closing

import mujoco
import numpy as np
import pytest
from components.companions.conftest import kick, move, with_caregiver
from hypothesis import given, settings, strategies as st

import mimoc
from mimoc.base.errors import MimocError, SpecError, UnknownNameError
from mimoc.base.geometry.adult import SIDES
from mimoc.compiler.explain import explain
from mimoc.components.companions.body import PEAK_M_S, PEAK_RAD_S
from mimoc.runtime.sound import Sound

BALL = {"name": "ball", "radius_cm": 3, "mass_g": 40, "at": {"x_cm": 15, "y_cm": 30}}


def test_a_bundle_has_a_caregiver_only_if_its_spec_has_one(built):
    alone = mimoc.build(mimoc.InfantSpec(mimoc=1, name="x", age_months=4))
    assert b"caregiver" not in alone.files["manifest.json"] + alone.files["scene.xml"]
    assert b"caregiver" not in alone.files["resolved.yaml"]
    assert mimoc.build(with_caregiver()).manifest.caregiver is not None


@pytest.mark.parametrize("pose", ["supine", "sitting", "standing"])
def test_plain_mujoco_opens_it_and_shows_it_where_the_runtime_does(tmp_path, cared_for, pose):
    env = cared_for()
    env.reset(options={"pose": pose})
    folder = mimoc.write_bundle(env.bundle, tmp_path / "out")
    model = mujoco.MjModel.from_xml_path(str(folder / "scene.xml"))
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, model.key(pose).id)
    mujoco.mj_forward(model, data)
    for part in ("head", "trunk"):
        assert data.body(f"caregiver_{part}").xpos == pytest.approx(env.data.body(f"caregiver_{part}").xpos, abs=1e-6)
    with closing(mimoc.make(folder)) as again:
        assert again.unwrapped.manifest == env.manifest


@pytest.mark.parametrize(("place", "distance_cm"), [("in_front", 30), ("above", 50), ("beside", 60)])
@pytest.mark.parametrize("pose", ["supine", "sitting", "standing", "prone"])
def test_its_face_is_as_far_away_as_asked_and_looks_at_the_infant(cared_for, place, distance_cm, pose):
    env = cared_for({"place": place, "distance_cm": distance_cm}, scene={"pose": pose}, age_months=12)
    infant, body = env.caregiver.infant, env.caregiver.body
    way_m = infant.face_m(env.data) - body.face_m(env.data)
    gaze = env.data.xmat[body.head].reshape(3, 3)[:, 0]
    assert gaze @ way_m / np.linalg.norm(way_m) > 0.999
    assert np.linalg.norm(way_m) >= distance_cm / 100 - 0.01  # Farther, where the floor is in its way.
    if pose == "supine" and place != "beside":
        assert np.linalg.norm(way_m) == pytest.approx(distance_cm / 100, abs=0.005)
    assert not body.touches(env.data, infant)


def test_acts_of_the_script_begin_at_their_physics_steps(cared_for):
    script = [
        {"at_s": 0.1, "do": "show_face", "face": "sad"},
        {"at_s": 0.25, "do": "speak", "pitch_hz": 300, "duration_ms": 200},
        {"at_s": 0.25, "do": "look_away"},
    ]
    env = cared_for({"script": script})
    move(env, 0.4)
    assert env.caregiver.acts == [(20, "show_face", "sad"), (50, "speak", None), (50, "look_away", None)]
    (voice,) = env.caregiver.sounds(env.data)
    assert (voice.start_step, voice.fundamental_hz, voice.duration_ms, voice.kind) == (50, 300.0, 200.0, "voice")
    move(env, 3.0)
    assert env.caregiver.sounds(env.data) == []
    env.reset()
    assert env.caregiver.acts == []


def test_a_smile_passes_and_a_face_stays(cared_for):
    env = cared_for({"expression": "sad"})

    def shown() -> str:
        return env.model.material(int(env.model.geom("caregiver_face").matid[0])).name

    assert shown() == "caregiver_face_sad"
    env.caregiver.do("smile", duration_ms=100)
    move(env, 0.05)
    assert shown() == "caregiver_face_happy"
    move(env, 0.1)
    assert shown() == "caregiver_face_sad"
    env.caregiver.do("show_face", "surprised")
    move(env, 0.3)
    assert shown() == "caregiver_face_surprised"
    env.reset()
    assert shown() == "caregiver_face_sad"


def test_it_looks_away_and_back_at_the_speed_of_heads(cared_for):
    env = cared_for()
    head, speeds = env.caregiver.body.head, []
    for act in ("look_away", "look_at"):
        env.caregiver.do(act)
        before = env.data.xmat[head].reshape(3, 3).copy()
        for _ in range(150):
            move(env, 0.01)
            now = env.data.xmat[head].reshape(3, 3).copy()
            speeds.append(np.arccos(np.clip((np.trace(now @ before.T) - 1) / 2, -1, 1)) / 0.01)
            before = now
        way_m = env.caregiver.infant.face_m(env.data) - env.caregiver.body.face_m(env.data)
        is_seen = now[:, 0] @ way_m / np.linalg.norm(way_m) > 0.99
        assert is_seen == (act == "look_at")
    assert 0.8 * PEAK_RAD_S < max(speeds) < 1.1 * PEAK_RAD_S


@pytest.mark.parametrize("age_months", [0, 9])
@pytest.mark.parametrize("pose", ["supine", "sitting"])
@pytest.mark.parametrize("order", [("hold", "chest", 0.4), ("hold", "left_foot", None), ("offer", "ball", None)])
def test_hands_move_as_fast_as_hands_do_and_never_through_the_infant(cared_for, age_months, pose, order):
    """The infant flails meanwhile."""
    act, what, share = order
    env = cared_for(age_months=age_months, scene={"pose": pose, "objects": [BALL]})
    body, infant = env.caregiver.body, env.caregiver.infant
    env.caregiver.do(act, what, **({} if share is None else {"weight_share": share}))
    speeds, deepest_m = [], 0.0
    places = np.array([env.data.xpos[body.hands[side]] for side in SIDES])
    for step in range(250):
        move(env, 0.01, strength=0.5, seed=step)
        now = np.array([env.data.xpos[body.hands[side]] for side in SIDES])
        speeds.append(np.linalg.norm(now - places, axis=1).max() / 0.01)
        places = now
        first, second = env.data.contact.geom.T
        of_both = (body.is_its_geom[first] & infant.is_its_geom[second]) | (
            body.is_its_geom[second] & infant.is_its_geom[first]
        )
        deepest_m = min([deepest_m, *env.data.contact.dist[of_both]])
    assert 0.25 < max(speeds) < 1.1 * PEAK_M_S
    assert deepest_m > -0.006


def test_what_is_offered_comes_within_reach_of_a_hand_and_falls_when_released(cared_for):
    env = cared_for(scene={"objects": [BALL]})
    env.caregiver.do("offer", "ball")
    move(env, 5)
    hands = [env.data.body(f"{side}_hand").xpos for side in SIDES]
    ball_m = env.data.body("object_ball").xpos
    assert min(np.linalg.norm(hand - ball_m) for hand in hands) - 0.03 < 0.1
    assert ball_m[2] > 0.06
    env.caregiver.do("release")
    move(env, 1)
    assert env.data.body("object_ball").xpos[2] < 0.06


def on_the_floor_n(env: mimoc.InfantEnv) -> float:
    """Return the force with which the world carries the infant."""
    wrench, total = np.zeros(6), 0.0
    for index, contact in enumerate(env.data.contact):
        if 0 in env.model.geom_bodyid[contact.geom]:
            mujoco.mj_contactForce(env.model, env.data, index, wrench)
            total += abs(float((contact.frame.reshape(3, 3).T @ wrench[:3])[2]))
    return total


@pytest.mark.full
@pytest.mark.parametrize("share", [0.0, 0.3, 0.5])
def test_it_carries_the_share_of_the_weight_that_is_asked(cared_for, share):
    env = cared_for()
    env.caregiver.do("hold", "chest", weight_share=share)
    move(env, 5)
    assert on_the_floor_n(env) / env.caregiver.infant.weight_n == pytest.approx(1 - share, abs=0.05)
    env.caregiver.do("release")
    move(env, 2)
    assert on_the_floor_n(env) / env.caregiver.infant.weight_n == pytest.approx(1, abs=0.02)
    assert not env.data.xfrc_applied.any()


def test_a_part_that_it_holds_stays_where_it_is(cared_for):
    env = cared_for()
    env.caregiver.do("hold", "left_foot")
    move(env, 2.5)
    held_m, free_m = (env.data.body(f"{side}_foot").xpos.copy() for side in SIDES)
    moved_m = np.zeros(2)
    for _ in range(20):
        kick(env, 0.1)
        now = (env.data.body(f"{side}_foot").xpos for side in SIDES)
        moved_m = np.maximum(moved_m, [np.linalg.norm(a - b) for a, b in zip(now, (held_m, free_m), strict=True)])
    assert moved_m[0] < 0.02 < moved_m[1]


BUSY = {
    "script": [{"at_s": 0.05, "do": "look_away"}, {"at_s": 0.3, "do": "hold", "part": "chest", "weight_share": 0.4}],
    "answers": {"to": "kick", "probability": 0.5, "delay_ms": 100, "pause_ms": 200},
}


def test_a_copy_sees_what_the_original_sees_from_its_first_physics_step_on(cared_for):
    env = cared_for({"place": "above", "distance_cm": 30})
    for seed in range(4):
        move(env, 0.05, strength=1.0, seed=seed)
        with closing(copy.deepcopy(env)) as twin:
            assert (env.data.xmat == twin.data.xmat).all()
            assert env.data.ncon == twin.data.ncon
            assert (env.data.contact.dist == twin.data.contact.dist).all()
            assert (move(env, 0.01, strength=1.0) == move(twin, 0.01, strength=1.0)).all()


def test_states_include_the_caregiver(cared_for):
    env = cared_for(BUSY)
    move(env, 0.4, strength=1.0)
    env.caregiver.do("show_face", "sad")
    state = env.get_state()
    after, acts = move(env, 1, strength=1.0, seed=1), env.caregiver.acts
    env.reset(seed=5)
    env.set_state(state)
    assert (move(env, 1, strength=1.0, seed=1) == after).all()
    assert env.caregiver.acts == acts
    with pytest.raises(ValueError, match="cannot be restored"):
        env.set_state({**state, "companions": {"caregiver": {}}})


def test_it_stays_when_the_infant_grows(cared_for):
    env = cared_for({})
    env.caregiver.do("hold", "chest", weight_share=0.5)
    move(env, 3)
    place_m = env.data.body("caregiver_trunk").xpos.copy()
    env.grow(to=6)
    assert env.data.body("caregiver_trunk").xpos == pytest.approx(place_m)
    move(env, 3)
    assert on_the_floor_n(env) / env.caregiver.infant.weight_n == pytest.approx(0.5, abs=0.05)


def test_recordings_contain_what_it_was_asked_and_are_replayed(tmp_path):
    env = mimoc.Recorder(mimoc.make(with_caregiver(BUSY)), tmp_path / "recorded", states_every=20)
    with env:
        env.reset(seed=0)
        for step in range(60):
            if step in (5, 30):
                env.unwrapped.caregiver.do("show_face", "happy" if step == 5 else "sad")
            if step == 40:
                env.unwrapped.set_state(env.unwrapped.get_state())
                env.unwrapped.caregiver.do("speak", pitch_hz=300)
            env.step(env.action_space.sample())
        acts = env.unwrapped.caregiver.acts
    last = []
    replayed = list(mimoc.replay_recording(tmp_path / "recorded", watch=lambda env, _: last.append(env.caregiver.acts)))
    assert [item.difference for item in replayed] == [None]
    assert last[-1] == acts
    assert {act for _, act, _ in acts} >= {"show_face", "speak", "look_away", "hold"}


def test_a_policy_of_a_script_moves_it(cared_for):
    class Nanny(mimoc.Caregiver):
        def decide(self, data):
            if len(self.acts) == 0 and data.time > 0.1:
                self.do("look_away")

    with closing(mimoc.make(with_caregiver(), companions={"caregiver": Nanny()}).unwrapped) as env:
        env.reset(seed=0)
        move(env, 0.3)
        assert [(act, what) for _, act, what in env.caregiver.acts] == [("look_away", None)]


def test_its_face_can_be_told_apart_by_eyes_of_64_pixels():
    senses = {"vision": {"width_px": 64, "height_px": 64, "acuity": "off"}}
    with closing(mimoc.make(with_caregiver({"distance_cm": 30}, senses=senses)).unwrapped) as env:
        pictures = {}
        for face in ("neutral", "happy", "sad", "surprised"):
            env.reset(seed=0)
            env.caregiver.do("show_face", face)
            observation = env.step(np.zeros(env.action_space.shape, np.float32))[0]
            pictures[face] = next(value for value in observation.values() if value.dtype == np.uint8).astype(int)
        for face in ("happy", "sad", "surprised"):
            differs = np.abs(pictures[face] - pictures["neutral"]).max(axis=2) > 20
            assert 8 < np.count_nonzero(differs) < 0.1 * differs.size


@pytest.mark.parametrize(
    ("order", "error", "message"),
    [
        (("sing",), UnknownNameError, "sing"),
        (("show_face", "bored"), UnknownNameError, "bored"),
        (("offer", "bal"), UnknownNameError, "bal"),
        (("hold", "wheel"), UnknownNameError, "wheel"),
        (("offer",), MimocError, "needs the name of the object"),
    ],
)
def test_what_it_cannot_do_is_refused(cared_for, order, error, message):
    env = cared_for(scene={"objects": [BALL]})
    with pytest.raises(error, match=message):
        env.caregiver.do(*order)
    with pytest.raises(UnknownNameError, match="duration_s"):
        env.caregiver.do("speak", duration_s=1)
    assert env.caregiver.orders == []


@pytest.mark.parametrize(
    ("scene", "message"),
    [
        ({"objects": [{**BALL, "motion": "fixed"}]}, "'ball' is fixed; offer something that moves freely"),
        ({"toys": {"count": [1, 1], "subset": ["cup"]}}, "there is no 'ball' in this scene; choose from"),
    ],
)
def test_a_script_offers_only_what_it_can_take(scene, message):
    data = with_caregiver({"script": [{"do": "offer", "object": "ball"}]}, scene=scene)
    with pytest.raises(SpecError, match=re.escape(f"scene.caregiver.script[0].object: {message}")):
        mimoc.build(data)


def test_its_derived_numbers_are_explained(cared_for):
    bundle = cared_for({"answers": {}}).bundle
    for key in ("scale", "infant_face_m", "answers.kick_m"):
        assert explain(bundle, f"caregiver.{key}")


STEP_MS = 5.0


def answering(env_of, **answers) -> mimoc.InfantEnv:
    return env_of({"answers": {"to": "kick", "by": ["smile", "speak"], **answers}})


@given(delay=st.integers(0, 120))
@settings(max_examples=4)
def test_an_answer_comes_after_the_set_delay_to_the_physics_step(delay):
    spec = with_caregiver({"answers": {"delay_ms": delay * STEP_MS, "pause_ms": 0}})
    env = mimoc.make(spec).unwrapped
    env.reset(seed=0)
    kick(env, 2)
    caregiver, due, free = env.caregiver, list[int](), 0
    for step in caregiver.noticed:
        if step >= free:  # Nothing is answered while an answer is due.
            free = step + delay
            due += [free] if free < 400 else []
    assert len(due) > 1
    assert caregiver.answered == due
    voices = [sound.start_step for sound in caregiver.sounds(env.data)]
    assert voices
    assert voices == due[-len(voices) :]
    env.close()


def test_a_pause_follows_an_answer(cared_for):
    env = answering(cared_for, delay_ms=0, pause_ms=1000)
    kick(env, 4)
    assert len(env.caregiver.answered) > 1
    assert min(np.diff(env.caregiver.answered)) >= 200


@pytest.mark.parametrize(("probability", "lowest", "highest"), [(0.0, 0, 0), (0.5, 0.2, 0.8), (1.0, 1, 1)])
def test_answers_are_as_probable_as_set_and_drawn_by_the_seed(cared_for, probability, lowest, highest):
    env = answering(cared_for, delay_ms=0, pause_ms=0, probability=probability)
    kick(env, 4)
    answered = env.caregiver.answered
    assert lowest <= len(answered) / len(env.caregiver.noticed) <= highest
    env.reset(seed=0)
    kick(env, 4)
    assert env.caregiver.answered == answered


def test_a_kick_is_a_leg_that_gets_longer_by_a_quarter_of_the_trunk(cared_for):
    env = answering(cared_for, delay_ms=0, pause_ms=0)
    least_m, infant = env.manifest.caregiver.answers.kick_m, env.caregiver.infant
    lengths = []
    for _ in range(300):
        kick(env, 0.01)
        lengths.append(infant.leg_lengths_m(env.data))
    spans_m = np.ptp(lengths, axis=0)
    assert env.caregiver.noticed
    assert spans_m.max() > least_m
    env.reset(seed=0)
    move(env, 1)
    assert not env.caregiver.noticed


def test_yoked_answers_come_whatever_the_infant_does(cared_for):
    env = answering(cared_for, yoked_s=[0.1, 0.5])
    move(env, 1)
    assert env.caregiver.answered == [20, 100]
    other = answering(cared_for, yoked_s=[step * STEP_MS / 1000 for step in env.caregiver.answered])
    kick(other, 1)
    assert other.caregiver.answered == [20, 100]
    assert other.caregiver.noticed


def test_a_still_face_answers_nothing(cared_for):
    script = [{"at_s": 1, "do": "still_face"}, {"at_s": 3, "do": "interact"}]
    env = cared_for({"script": script, "answers": {"delay_ms": 100, "pause_ms": 0}})
    kick(env, 5)
    answered, noticed = np.array(env.caregiver.answered), np.array(env.caregiver.noticed)
    assert ((noticed > 200) & (noticed < 600)).any()
    assert not ((answered >= 200) & (answered < 620)).any()
    assert (answered < 200).any()
    assert (answered >= 620).any()


def test_a_look_at_its_face_is_answered_once(cared_for):
    """An infant on its back looks at a face in front of it."""
    env = answering(cared_for, to="gaze", delay_ms=0, pause_ms=0)
    move(env, 1)
    assert env.caregiver.noticed == [40]


def test_touching_it_is_answered(cared_for):
    env = cared_for({"answers": {"to": "touch", "delay_ms": 0}})
    move(env, 0.5)
    assert not env.caregiver.noticed
    env.caregiver.do("hold", "chest")
    move(env, 3)
    assert env.caregiver.answered


class Voice(mimoc.Companion):
    """The voice of an infant, at times of a script."""

    def sounds(self, data):
        steps = [step for step in (30, 150) if step * STEP_MS / 1000 <= data.time + 1e-9]
        return [Sound(step, 300.0, 400.0, 60.0, "voice", "infant", 1, (0.0, 0.0, 0.0)) for step in steps]


def test_the_voice_of_the_infant_is_answered():
    spec = with_caregiver({"answers": {"to": "vocalisation", "delay_ms": 200, "pause_ms": 0}})
    env = mimoc.make(spec, companions={"voice": Voice()}).unwrapped
    env.reset(seed=0)
    move(env, 2)
    assert env.caregiver.noticed == [30, 150]
    assert env.caregiver.answered == [70, 190]
    env.close()
