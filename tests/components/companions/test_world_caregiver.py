"""A caregiver of several infants: whom it is by, whom it attends to, whom it answers, and where it is not."""

import copy
import pickle
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import pytest
from components.companions.conftest import KICK_S
from support.worlds import placed

import mimoc
from mimoc.base.errors import KindError, MimocError, SpecError, UnknownNameError
from mimoc.compiler.worlds import plan_world
from mimoc.components.companions.caregiver import Caregiver
from mimoc.runtime.opening import shared_world
from mimoc.runtime.sound import Sound
from mimoc.runtime.world_env import WorldEnv

LYING: dict[str, Any] = {"mimoc": 1, "name": "x", "age_months": 4, "scene": {"pose": "supine"}}
PAIR = {"anna": LYING, "ben": {**LYING, "age_months": 5}}
ANSWERS = {"answers": {"to": "kick", "delay_ms": 0, "pause_ms": 0}}


@pytest.fixture
def lives() -> Iterator[Callable[..., WorldEnv]]:
    """Return what opens a world of two infants with a caregiver, reset with seed 0."""
    opened = list[WorldEnv]()

    def give(caregiver: dict[str, Any], companions: Any = None, **scene: Any) -> WorldEnv:
        infants = {name: mimoc.InfantSpec.model_validate(data) for name, data in PAIR.items()}
        bundle = mimoc.build_world(infants, scene={"caregiver": caregiver, **scene})
        opened.append(shared_world(bundle, companions=companions or {}))
        opened[-1].reset(seed=0)
        return opened[-1]

    yield give
    for env in opened:
        env.close()


def kick(env: WorldEnv, names: tuple[str, ...], seconds: float) -> None:
    """Let some infants bend and stretch their legs with all their strength."""
    for _ in range(round(100 * seconds)):
        sign = 1.0 if env.data.time % KICK_S > KICK_S / 2 else -1.0
        actions = {}
        for name, infant in env.infants.items():
            joints = [env.model.actuator(int(index)).name for index in infant.actuation.actuators]
            legs = np.array([joint.endswith(("_hip_flex", "_knee")) for joint in joints])
            actions[name] = (sign * legs * (name in names)).astype(np.float32)
        env.step(actions)


def test_a_world_has_one_caregiver_which_each_infant_has(lives):
    env = lives({})
    anna, ben = env.infants.values()
    assert anna.caregiver is ben.caregiver
    assert anna.caregiver.attends_to == "anna"
    assert env.bundle.manifest.caregiver.infant == "anna"
    assert env.model.nmocap == 9


@pytest.mark.parametrize("who", ["anna", "ben"])
def test_whoever_kicks_is_answered_and_attended_to(lives, who):
    env = lives(ANSWERS)
    caregiver = env.infants["anna"].caregiver
    kick(env, (who,), 2)
    assert caregiver.answered
    assert set(caregiver.answered_to) == set(caregiver.noticed_of) == {who}
    assert caregiver.attends_to == who
    head, face_m = env.data.body(caregiver.entry.head), caregiver.infants[who].face_m(env.data)
    way = (face_m - head.xpos) / np.linalg.norm(face_m - head.xpos)
    assert head.xmat.reshape(3, 3)[:, 0] @ way > 0.9


def test_of_two_who_kick_at_once_the_first_is_answered_first(lives):
    env = lives({"answers": {"to": "kick", "delay_ms": 100, "pause_ms": 60_000}})
    kick(env, ("anna", "ben"), 2)
    caregiver = env.infants["anna"].caregiver
    assert set(caregiver.noticed_of) == {"anna", "ben"}
    assert caregiver.answered_to == [caregiver.noticed_of[0]]


def test_one_that_is_named_is_answered_alone(lives):
    env = lives({**ANSWERS, "infant": "ben"})
    caregiver = env.infants["anna"].caregiver
    kick(env, ("anna", "ben"), 2)
    assert set(caregiver.noticed_of) == {"ben"}
    face_m = {name: infant.face_m(env.data) for name, infant in caregiver.infants.items()}
    head_m = env.data.body(caregiver.entry.head).xpos
    assert np.linalg.norm(face_m["ben"] - head_m) < np.linalg.norm(face_m["anna"] - head_m)


def test_acts_turn_to_the_infant_that_they_name(lives):
    env = lives({"script": [{"at_s": 0.05, "do": "speak", "infant": "ben"}]})
    caregiver = env.infants["ben"].caregiver
    kick(env, (), 0.1)
    assert caregiver.attends_to == "ben"
    caregiver.do("hold", "left_foot", infant="anna")
    kick(env, (), 0.05)
    assert caregiver.attends_to == "anna"
    assert {task.get("part") for task in caregiver.hands.state["tasks"].values()} > {
        env.model.body("anna_left_foot").id
    }
    with pytest.raises(UnknownNameError, match="did you mean 'ben'"):
        caregiver.do("speak", infant="bem")


def test_what_is_offered_comes_within_reach_of_the_infant_that_is_named(lives):
    env = lives({}, objects=[{"name": "ball", "at": "within reach of left_hand"}])
    caregiver = env.infants["anna"].caregiver
    caregiver.do("offer", "ball", infant="ben")
    kick(env, (), 8)
    ball_m = env.data.body("object_ball").xpos
    nearest_m = {
        name: min(float(np.linalg.norm(env.data.xpos[hand] - ball_m)) for hand in infant.hands)
        for name, infant in caregiver.infants.items()
    }
    assert nearest_m["ben"] < 0.3
    assert nearest_m["ben"] < nearest_m["anna"]


def test_a_caregiver_goes_on_in_states_copies_and_pickles(lives):
    env = lives({**ANSWERS, "script": [{"at_s": 0.1, "do": "hold", "part": "left_foot", "infant": "ben"}]})
    kick(env, ("anna",), 0.5)
    state, copied, pickled = env.get_state(), copy.deepcopy(env), pickle.loads(pickle.dumps(env))
    kick(env, ("anna", "ben"), 0.5)
    after = env.get_state()["physics"]
    for other in (copied, pickled):
        kick(other, ("anna", "ben"), 0.5)
        assert np.array_equal(other.get_state()["physics"], after)
        assert other.infants["ben"].caregiver.acts == env.infants["ben"].caregiver.acts
        other.close()
    env.set_state(state)
    kick(env, ("anna", "ben"), 0.5)
    assert np.array_equal(env.get_state()["physics"], after)


def test_an_infant_of_a_world_of_one_has_the_caregiver_that_it_has_alone():
    """The same kicks are noticed and answered at the same steps."""
    scene = {"pose": "supine", "caregiver": ANSWERS}
    alone = mimoc.make(mimoc.InfantSpec.model_validate({**LYING, "scene": scene})).unwrapped
    world = shared_world(placed({"x": LYING}, {}, scene={"caregiver": ANSWERS}))
    alone.reset(seed=0)
    world.reset(seed=0)
    kick(world, ("x",), 2)
    names = [alone.model.actuator(int(index)).name for index in alone.actuation.actuators]
    legs = np.array([name.endswith(("_hip_flex", "_knee")) for name in names])
    for _ in range(200):
        alone.step(((1.0 if alone.data.time % KICK_S > KICK_S / 2 else -1.0) * legs).astype(np.float32))
    assert world.infants["x"].caregiver.answered == alone.caregiver.answered != []
    assert np.array_equal(world.data.mocap_pos, alone.data.mocap_pos)
    assert np.array_equal(world.data.qpos, alone.data.qpos)
    alone.close()
    world.close()


FACING = {"y_cm": 25, "yaw_deg": -90}, {"y_cm": -25, "yaw_deg": 90}
SITTING = {name: {**data, "age_months": 8, "scene": {"pose": "sitting"}} for name, data in PAIR.items()}


def test_between_infants_face_to_face_there_is_no_room_so_it_is_beside():
    entry = placed(SITTING, *FACING, scene={"caregiver": {}}).manifest.caregiver
    assert (entry.place, entry.side, entry.infant) == ("beside", "left", "anna")


def test_a_place_with_another_infant_in_it_is_refused():
    with pytest.raises(SpecError, match=r"scene\.caregiver: 'ben' would be within it, or in its way; give another"):
        placed(SITTING, *FACING, scene={"caregiver": {"place": "in_front"}})


def test_a_caregiver_of_a_script_is_passed_with_the_first_infant(lives):
    class Nanny(Caregiver):
        def decide(self, data):
            if data.time == 0:
                self.do("smile", infant="ben")

    env = lives({}, {"anna": {"caregiver": Nanny()}})
    kick(env, (), 0.05)
    assert env.infants["ben"].caregiver.attends_to == "ben"
    with pytest.raises(KindError, match="a world has one caregiver; pass it with the first infant"):
        lives({}, {"ben": {"caregiver": Nanny()}})


def test_a_caregiver_goes_on_when_infants_grow():
    infants = {name: mimoc.InfantSpec.model_validate(data) for name, data in PAIR.items()}
    env = shared_world(plan_world(infants, scene={"caregiver": ANSWERS}))
    env.reset(seed=0)
    kick(env, ("ben",), 1)
    answered = env.infants["anna"].caregiver.answered
    env.grow({"ben": 5.5})
    assert env.infants["anna"].caregiver.attends_to == "ben"
    kick(env, ("ben",), 1)
    assert env.infants["anna"].caregiver.answered[: len(answered)] == answered
    assert len(env.infants["anna"].caregiver.answered) > len(answered)
    env.close()


def test_a_world_without_a_caregiver_says_so():
    env = shared_world({name: mimoc.InfantSpec.model_validate(data) for name, data in PAIR.items()})
    with pytest.raises(MimocError, match=r"has no caregiver; add 'caregiver: \{\}' to the scene"):
        _ = env.infants["ben"].caregiver
    env.close()


def test_rows_of_a_batch_of_worlds_have_the_caregiver_that_the_world_has_alone():
    plan = plan_world(
        {name: mimoc.InfantSpec.model_validate(data) for name, data in PAIR.items()}, scene={"caregiver": ANSWERS}
    )
    env, envs = shared_world(plan), mimoc.make_vec(plan, num_envs=4)
    env.reset(seed=0)
    envs.reset(seed=0)
    generator = np.random.default_rng(0)
    for _ in range(60):
        actions = generator.uniform(-1, 1, envs.action_space.shape).astype(np.float32)
        envs.step(actions)
        env.step(dict(zip(env.agents, actions[:2], strict=True)))
    assert np.array_equal(envs.simulations[0].data.qpos, env.data.qpos)
    assert np.array_equal(envs.simulations[0].data.mocap_pos, env.data.mocap_pos)
    env.close()
    envs.close()


class Crying(mimoc.Companion):
    """An infant's cry, once."""

    def sounds(self, data):
        return [Sound(20, 400.0, 450.0, 80.0, "voice", "infant", 1, (0.0, 0.0, 0.0))] if data.time > 0.1 else []


@pytest.mark.parametrize("who", ["anna", "ben"])
def test_whoever_cries_is_answered(lives, who):
    env = lives({"answers": {"to": "vocalisation", "delay_ms": 0}}, {who: {"cry": Crying()}})
    kick(env, (), 0.3)
    assert env.infants["anna"].caregiver.answered_to == [who]
