"""Infants in a world grow, change their scene and have objects elsewhere, as an infant that is alone."""

import copy
import pickle

import numpy as np
import pytest
from support.worlds import ANNA, BEN, plan_of, world

import mimoc
from mimoc.base.errors import MimocError, UnknownNameError
from mimoc.runtime.opening import prepared_world, shared_world
from mimoc.runtime.world_env import WorldEnv
from mimoc.schema.infant import InfantSpec

BLOCK = {"kind": "shape", "name": "block", "shape": "box", "sides_cm": [6, 6, 6], "at": {"x_cm": 100, "y_cm": 0}}
KIM, LEE = (InfantSpec.model_validate({**data, "name": name}) for name, data in (("kim", ANNA), ("lee", BEN)))


def opened(**keys) -> WorldEnv:
    """Return a world that was made from specs."""
    return mimoc.make_parallel({"kim": KIM, "lee": LEE}, **keys)


def rest(env: WorldEnv) -> dict[str, np.ndarray]:
    return {name: env.infants[name].rest for name in env.agents}


def test_an_infant_grows_in_the_midst_of_an_episode_and_the_other_stays_as_it_is():
    env = opened()
    env.reset(seed=0)
    env.step(rest(env))
    before = {name: env.data.body(f"{name}_head").xpos.copy() for name in env.infants}
    mass = {name: env.model.body(f"{name}_head").mass[0] for name in env.infants}
    observations = env.grow({"kim": 14})
    assert {name: infant.age_months for name, infant in env.infants.items()} == {"kim": 14.0, "lee": 3.0}
    assert env.bundle.infants["kim"].manifest.child.age_months == 14.0
    assert env.model.body("kim_head").mass[0] > 1.02 * mass["kim"]
    assert env.model.body("lee_head").mass[0] == mass["lee"]
    assert np.allclose(env.data.body("lee_head").xpos, before["lee"], atol=2e-3)
    assert np.linalg.norm(env.data.body("kim_head").xpos - before["kim"]) < 0.1
    for name, observation in observations.items():
        assert env.observation_space(name).contains(observation)
    _, _, _, _, infos = env.step(rest(env))
    assert (infos["kim"]["age_months"], infos["kim"]["unstable"]) == (14.0, False)


def test_it_grows_as_it_does_alone():
    """Far from others, with signals on their way and the task going on."""
    late = {**ANNA, "delays": {"sensory_ms": 30, "motor_ms": 20}, "task": {"kind": "selfbody"}}
    spec = InfantSpec.model_validate({**late, "name": "kim"})
    alone, shared = mimoc.make(spec).unwrapped, shared_world({"kim": spec})
    ours, _ = alone.reset(seed=3)
    theirs, _ = shared.reset(seed=3)
    generator = np.random.default_rng(0)
    for step in range(6):
        if step == 3:
            alone.grow(to=9.5)
            shared.grow({"kim": 9.5})
        action = generator.uniform(-0.3, 0.3, alone.action_space.shape).astype(np.float32)
        ours, reward, *_ = alone.step(action)
        theirs, rewards, *_ = shared.step({"kim": action})
        assert rewards["kim"] == pytest.approx(reward, abs=1e-6)
        for name, reading in ours.items():
            assert np.allclose(reading, theirs["kim"][name], rtol=1e-5, atol=1e-5), (step, name)


def test_a_reset_gives_ages_a_scene_and_places():
    env = opened(scene={"kind": "flat", "objects": [BLOCK]})
    moved = {"block": {"x_cm": 70, "y_cm": 5}}
    env.reset(seed=0, options={"kim": {"age_months": 10}, "scene_seed": 7, "objects": moved})
    assert (env.infants["kim"].age_months, env.bundle.manifest.seed) == (10.0, 7)
    assert np.allclose(env.data.body("object_block").xpos[:2], (0.7, 0.05), atol=1e-3)
    env.reset(options={"lee": {"objects": {"block": {"x_cm": -70, "y_cm": 5}}}})
    assert np.allclose(env.data.body("object_block").xpos[:2], (-0.7, 0.05), atol=1e-3)
    env.reset()
    assert np.allclose(env.data.body("object_block").xpos[:2], (1.0, 0.0), atol=1e-3)
    assert (env.infants["kim"].age_months, env.bundle.manifest.seed) == (10.0, 7)


def test_states_and_copies_have_ages_and_scenes():
    env = opened()
    env.reset(seed=0)
    env.grow({"kim": 10, "lee": 4})
    env.step(rest(env))
    state = env.get_state()
    others = [opened(), copy.deepcopy(env), pickle.loads(pickle.dumps(env))]
    others[0].set_state(state)
    observed, *_ = env.step(rest(env))
    for other in others:
        assert {name: infant.age_months for name, infant in other.infants.items()} == {"kim": 10.0, "lee": 4.0}
        again, *_ = other.step(rest(other))
        for name in observed:
            assert all(np.array_equal(observed[name][sense], again[name][sense]) for sense in observed[name])


def test_a_schedule_of_growth_holds_for_the_infants_that_have_one():
    env = opened()
    env.simulation.grow_by({"lee": mimoc.growth_schedule("grown", ages_months=(3, 4), steps=4)})
    env.reset(seed=0)
    ages = []
    for _ in range(6):
        env.step(rest(env))
        ages.append((env.infants["kim"].age_months, env.infants["lee"].age_months))
    assert ages[0] == (9.0, 3.0)
    assert ages[-1] == (9.0, 4.0)


def test_infants_that_a_reset_would_make_too_large_for_their_places_are_refused():
    near = {"y_cm": 0}, {"y_cm": 56}
    env = WorldEnv(**prepared_world(plan_of({"kim": ANNA, "lee": ANNA}, *near)))
    env.reset(seed=0)
    with pytest.raises(MimocError, match="'kim' and 'lee' are within each other as they start"):
        env.reset(options={"kim": {"age_months": 24}, "lee": {"age_months": 24}})
    assert env.agents == []


@pytest.mark.parametrize(
    ("options", "kind", "message"),
    [
        ({"kim": {"age_months": 25}}, ValueError, "expected an age from 0 to 24 months"),
        ({"scene_seed": None}, ValueError, "non-negative integer"),
        ({"objects": ["block"]}, ValueError, "expected a dictionary of places"),
        ({"kim": {"objects": 3}}, ValueError, "expected a dictionary of places"),
        ({"objects": {"blok": {"x_cm": 1, "y_cm": 2}}}, UnknownNameError, "'blok' is not a named object"),
    ],
)
def test_a_reset_that_is_refused_before_it_begins_leaves_all_as_they_are(options, kind, message):
    env = opened(scene={"kind": "flat", "objects": [BLOCK]})
    env.reset(seed=0)
    state = env.get_state()
    with pytest.raises(kind, match=message):
        env.reset(options=options)
    assert env.agents == ["kim", "lee"]
    assert np.array_equal(env.get_state()["physics"], state["physics"])


def test_the_options_of_a_reset_are_the_callers_own():
    env = opened(scene={"kind": "flat", "objects": [BLOCK]})
    options = {"kim": {"objects": {}}, "objects": {"block": {"x_cm": 70, "y_cm": 5}}}
    before = copy.deepcopy(options)
    env.reset(seed=0, options=options)
    assert options == before


class Breeze(mimoc.Companion):
    """Pushes the other infant, and does so by what it has felt."""

    def before_step(self, data):
        data.xfrc_applied[-1, 0] = 0.01 * data.ncon


def test_a_state_has_what_companions_of_any_infant_see():
    """Also if an infant before theirs has a companion of its senses, as hearing is."""
    hearing = InfantSpec.model_validate({**ANNA, "name": "kim", "senses": {"hearing": {"output": "levels"}}})
    env = mimoc.make_parallel({"kim": hearing, "lee": LEE}, companions={"lee": {"breeze": Breeze()}})
    env.reset(seed=0)
    for _ in range(3):
        env.step(rest(env))
    state = env.get_state()
    assert len(state["before"])
    first, *_ = env.step(rest(env))
    env.set_state(state)
    again, *_ = env.step(rest(env))
    for name in first:
        assert all(np.array_equal(first[name][sense], again[name][sense]) for sense in first[name])


@pytest.mark.parametrize(
    ("wrong", "kind", "message"),
    [
        ({"ann": 9}, UnknownNameError, "'ann' is not a name of an infant of this world"),
        ({"kim": 25}, ValueError, "expected an age from 0 to 24 months"),
    ],
)
def test_ages_that_there_are_not_change_nothing(wrong, kind, message):
    env = opened()
    env.reset(seed=0)
    with pytest.raises(kind, match=message):
        env.grow(wrong)
    assert env.infants["kim"].age_months == 9.0
    env.step(rest(env))


def test_a_world_that_nothing_can_make_says_so():
    env = WorldEnv(world(anna=ANNA, ben=BEN))
    env.reset(seed=0)
    with pytest.raises(MimocError, match="can change neither the infant's age nor its scene"):
        env.grow({"anna": 10})
    with pytest.raises(UnknownNameError, match="'scene_seed' is not a name of an infant of this world"):
        env.reset(options={"scene_seed": 3})
