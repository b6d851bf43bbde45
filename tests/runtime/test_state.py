"""A state can be kept, sent elsewhere and gone back to: what follows is the same to the bit."""

import copy
import pickle
from itertools import combinations

import gymnasium
import numpy as np
import pytest
from support.running import actions
from support.same import same

import mimoc
from mimoc.base.errors import UnknownNameError
from mimoc.runtime.model_fields import expression_of
from mimoc.schema.body import EXPRESSIONS

SENSES = {
    "proprioception": {},
    "vestibular": {},
    "touch": {"density": 0.2},
    "vision": {"width_px": 8, "height_px": 6},
}
DELAYS = {"sensory_ms": 35, "vision_ms": 100, "motor_ms": 15}


@pytest.fixture(scope="module", params=["torque", "muscle"])
def bundle(request, built) -> mimoc.Bundle:
    """Return an infant with every sense, all signals late."""
    return built(senses=SENSES, delays=DELAYS, actuation={"model": request.param})


def run(env, commands):
    """Return what follows: observations and, at the end, the whole state of the physics."""
    seen = [env.step(command)[0] for command in commands]
    return seen, env.get_state()["physics"]


def test_what_follows_a_state_follows_it_again(open_env, bundle):
    env = open_env(bundle=bundle)
    env.reset(seed=0)
    run(env, actions(env, 30, 1))
    state, last = env.get_state(), env.step(env.action_space.high)[0]
    before = env.get_state()
    first = run(env, actions(env, 30))
    run(env, actions(env, 30, 2))
    env.reset(seed=3)
    observation = env.set_state(before)
    assert all(np.array_equal(observation[key], last[key]) for key in last)
    assert same(run(env, actions(env, 30)), first)
    env.set_state(state)
    again = env.step(env.action_space.high)[0]
    assert all(np.array_equal(again[key], last[key]) for key in last)


def test_a_state_is_not_changed_by_what_follows(open_env, bundle):
    env = open_env(bundle=bundle)
    env.reset(seed=0)
    run(env, actions(env, 5))
    state = env.get_state()
    kept = pickle.dumps(state)
    env.set_state(state)
    run(env, actions(env, 30))
    assert pickle.dumps(state) == kept


def test_chance_is_part_of_the_state(open_env, bundle):
    env = open_env(bundle=bundle)
    env.reset(seed=0)
    state = env.get_state()
    drawn = env.np_random.random(3)
    env.set_state(state)
    assert np.array_equal(env.np_random.random(3), drawn)


@pytest.mark.parametrize("duplicate", [copy.deepcopy, copy.copy, lambda env: pickle.loads(pickle.dumps(env))])
@pytest.mark.parametrize("wrapped", [False, True])
def test_a_copy_goes_on_where_the_environment_was(bundle, duplicate, wrapped):
    env = mimoc.make(bundle, render_mode="rgb_array") if wrapped else mimoc.InfantEnv(bundle)
    env.reset(seed=0)
    for command in actions(env, 30, 1):
        env.step(command)
    twin = duplicate(env)
    mine = run(env.unwrapped, actions(env, 30))
    if duplicate is not copy.copy or not wrapped:  # A shallow copy of a wrapper wraps the same environment.
        assert twin.unwrapped.data is not env.unwrapped.data
        assert same(run(twin.unwrapped, actions(env, 30)), mine)
    twin.close()
    env.close()


def test_a_copy_can_be_made_before_the_first_reset(bundle):
    env = mimoc.InfantEnv(bundle)
    twin = copy.deepcopy(env)
    for each in (env, twin):
        each.reset(seed=0)
    assert same(run(env, actions(env, 5)), run(twin, actions(env, 5)))
    twin.close()
    env.close()


def test_a_copy_keeps_what_was_changed_in_the_model_for_itself(bundle):
    env = mimoc.InfantEnv(bundle)
    env.set_expression("sad")
    twin = copy.deepcopy(env)
    env.set_expression("happy")
    face = env.manifest.face
    assert twin.model.skin(face.skin).matid == twin.model.material(face.materials["sad"]).id
    twin.close()
    env.close()


def test_the_state_of_another_infant_is_refused(open_env, bundle):
    env = open_env(bundle=bundle)
    other = open_env(body={"hands": "five_finger"})
    env.reset(seed=0)
    with pytest.raises(ValueError, match="state does not fit this infant"):
        env.set_state(other.get_state())
    env.step(env.action_space.high)


def test_an_infant_that_broke_down_is_well_again_in_an_earlier_state(open_env, bundle):
    env = open_env(bundle=bundle)
    env.reset(seed=0)
    state, first = env.get_state(), run(env, actions(env, 5))
    env.data.qvel[20] = np.nan
    assert env.step(env.action_space.high)[2]
    env.set_state(state)
    assert same(run(env, actions(env, 5)), first)


def test_a_time_limit_truncates(bundle):
    env = gymnasium.make("mimoc/Infant-v0", bundle=bundle, max_episode_steps=3)
    env.reset(seed=0)
    ends = [env.step(env.action_space.sample())[2:4] for _ in range(3)]
    assert ends == [(False, False), (False, False), (False, True)]
    env.close()


MIN_DIFFERENCE = 15
"""So many pixels of a picture of 240 by 240 differ at least: it shows."""


def opened(expression: str | None = None, size: int = 240, **body) -> mimoc.InfantEnv:
    body |= {} if expression is None else {"expression": expression}
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "body": body, "scene": {"kind": "flat", "pose": "sitting"}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(spec))
    env = mimoc.InfantEnv(bundle, render_mode="rgb_array", width=size, height=size)
    env.model.vis.quality.shadowsize = 0  # Shadows take time to draw.
    env.reset(seed=0)
    return env


@pytest.fixture(scope="module")
def env():
    env = opened()
    yield env
    env.close()


def picture(env, expression: str) -> np.ndarray:
    env.set_expression(expression)
    return env.render().astype(int)


def changed_pixels(one: np.ndarray, other: np.ndarray) -> int:
    return int((np.abs(one - other).max(axis=2) > 20).sum())


def test_there_are_nine(env):
    assert len(EXPRESSIONS) == 9
    assert set(env.manifest.face.materials) == set(EXPRESSIONS)


def test_every_two_of_them_look_different(env):
    pictures = {expression: picture(env, expression) for expression in EXPRESSIONS}
    for one, other in combinations(EXPRESSIONS, 2):
        assert changed_pixels(pictures[one], pictures[other]) > MIN_DIFFERENCE, (one, other)


def test_changing_back_and_forth_gives_the_same_picture(env):
    first = picture(env, "neutral")
    assert changed_pixels(first, picture(env, "happy"))
    assert np.array_equal(picture(env, "neutral"), first)


@pytest.mark.parametrize("expression", EXPRESSIONS)
def test_the_specs_expression_is_the_one_it_starts_with(env, expression):
    started = opened(expression)
    assert np.array_equal(started.render(), picture(env, expression))
    started.close()


@pytest.mark.parametrize("skin", [True, False])
def test_the_face_is_known_with_a_skin_and_without(skin):
    env = opened("sad", 16, skin=skin)
    assert expression_of(env.manifest, env.model) == "sad"
    env.set_expression("happy")
    assert expression_of(env.manifest, env.model) == "happy"
    env.close()


def test_it_can_be_changed_while_running_and_moves_nothing():
    """Also through Gymnasium's wrappers, by `env.unwrapped`."""
    serious, moody = opened(), opened()
    command = serious.action_space.high
    for expression in EXPRESSIONS:
        moody.unwrapped.set_expression(expression)
        serious.step(command)
        moody.step(command)
    assert np.array_equal(serious.data.qpos, moody.data.qpos)
    for env in (serious, moody):
        env.close()


def test_an_unknown_one_is_refused_and_changes_nothing(env):
    before = picture(env, "sad")
    with pytest.raises(UnknownNameError, match=r"'sadd' is not a facial expression of this infant; did you mean 'sad'"):
        env.set_expression("sadd")
    assert np.array_equal(env.render(), before)


def test_a_face_lasts_over_a_reset():
    env = opened("happy")
    env.set_expression("angry")
    angry = env.render()
    env.reset(seed=0)
    assert np.array_equal(env.render(), angry)
    env.close()
