"""What environments are given that makes no sense: a clear error, and nothing has changed."""

import copy
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from support.same import same

import mimoc
from mimoc.base.errors import MimocError

SENSES = {"proprioception": {}, "vestibular": {}, "touch": {"density": 0.1}}
NOISE = {"motor": 0.2, "proprioception_deg": 1.0, "touch_n": 0.05, "delay_jitter_ms": 10.0}
NONSENSE = [None, "a", float("nan"), -1, [], {}, 10**30, np.full(3, np.nan)]


@pytest.fixture
def env(open_env) -> mimoc.InfantEnv:
    env = open_env(senses=SENSES, delays={"preset": "physiological"}, noise=NOISE)
    env.reset(seed=1)
    env.step(np.zeros(env.action_space.shape))
    return env


def places(state: Any, path: tuple = ()) -> Iterator[tuple]:
    """Yield the path to everything in a state."""
    inner = state.items() if isinstance(state, dict) else enumerate(state) if isinstance(state, list) else ()
    for name, value in inner:
        yield (*path, name)
        yield from places(value, (*path, name))


def changed(state: dict[str, Any], path: tuple, value: Any) -> dict[str, Any]:
    state = copy.deepcopy(state)
    place = state
    for name in path[:-1]:
        place = place[name]
    if value is places:
        del place[path[-1]]
    else:
        place[path[-1]] = value
    return state


@pytest.mark.parametrize("state", [{}, None, [], 3, "a", {"age_months": 9, "scene_seed": 0}])
def test_what_is_no_state_is_refused(env, state):
    before = env.get_state()
    with pytest.raises(ValueError, match="this is not a state of an environment"):
        env.set_state(state)
    assert same(env.get_state(), before)


@pytest.mark.full
def test_a_state_with_anything_wrong_in_it_is_refused_whole_or_is_one(env):
    """Whatever is left out or replaced, wherever it is: either the infant lives on in it, or as before."""
    action = np.zeros(env.action_space.shape)
    state = env.get_state()
    env.reset(seed=2)
    before, refused = env.get_state(), 0
    for path in places(state):
        for value in (places, *NONSENSE):
            try:
                env.set_state(changed(state, path, value))
            except (ValueError, MimocError):
                refused += 1
                assert same(env.get_state(), before), path
            else:
                env.step(action)
                before = env.get_state()
    assert refused > 100


def test_numbers_that_are_none_are_refused(env):
    state = env.get_state()
    for path in places(state):
        value = state
        for name in path:
            value = value[name]
        if isinstance(value, np.ndarray) and value.dtype.kind == "f" and value.size and path[0] != "task":
            with pytest.raises(ValueError, match="NaN or an infinity"):
                env.set_state(changed(state, path, np.full_like(value, np.nan)))


@pytest.mark.parametrize("options", [[1], 1, "pose", np.zeros(3)])
def test_options_are_a_dictionary(env, options):
    with pytest.raises(TypeError, match="expected a dictionary of options"):
        env.reset(options=options)


@pytest.mark.parametrize("seed", [-1, 1.5, "a", [1], True, np.float64(3.0), b"x"])
def test_a_seed_is_a_non_negative_integer(env, seed):
    before = env.get_state()
    with pytest.raises(ValueError, match="expected a non-negative integer as seed"):
        env.reset(seed=seed)
    assert same(env.get_state(), before)


def test_a_seed_of_numpy_is_one(env):
    first = env.reset(seed=np.int64(3))[0]
    assert same(first, env.reset(seed=3)[0])


@pytest.mark.parametrize(
    "action",
    ["abc", ["a"] * 44, [object()] * 44, np.full(44, 1j), None, {"a": 1}, object(), [1, [2]], [10**400] * 44, 3, []],
    ids=str.split("word words objects complex nothing dictionary object ragged huge number empty"),
)
def test_an_action_is_an_array_of_numbers(env, action):
    before = env.get_state()
    with pytest.raises(ValueError, match="expected"):
        env.step(action)
    assert same(env.get_state(), before)


@pytest.mark.parametrize("name", [3, None, [], {}, "grin", b"happy"])
def test_names_that_are_none_are_told_of(env, name):
    with pytest.raises(MimocError, match="is not a facial expression of this infant"):
        env.set_expression(name)
    with pytest.raises(MimocError, match="is not a sense of this infant"):
        env.layout(name)


@pytest.mark.parametrize("size", [0, -5, 1_000_000, "a", 2.5, None, float("nan"), True])
def test_a_picture_has_a_size(bundle, size):
    with pytest.raises(ValueError, match="expected a width and a height from 1 to 16384 pixels"):
        mimoc.make(bundle, render_mode="rgb_array", width=size)


@pytest.mark.parametrize("mode", [3, [], "rgb", b"human"])
def test_a_render_mode_has_a_name(bundle, mode):
    with pytest.raises(MimocError, match="is not a render mode"):
        mimoc.make(bundle, render_mode=mode)


@pytest.mark.parametrize("source", [None, 3, b"x", [], {}, object()])
def test_an_infant_is_made_from_a_bundle_a_spec_or_a_path(source):
    with pytest.raises(TypeError, match="expected a bundle, a spec, or the path of one, got"):
        mimoc.make(source)


@pytest.mark.parametrize("path", ["a\0b", "9" * 5000, "a\0b.yaml", f"{'9' * 5000}.yaml"])
def test_a_path_that_no_file_can_have_is_told_of(path):
    with pytest.raises(MimocError):
        mimoc.make(path)


@pytest.fixture(scope="module")
def pair(bundle):
    envs = mimoc.make_vec(bundle, num_envs=2)
    yield envs
    envs.close()


@pytest.mark.parametrize("states", ["none", "empty", "one", "wrong"])
def test_states_of_many_are_restored_all_or_none(pair, states):
    pair.reset(seed=0)
    before = pair.get_state()
    given = {"none": None, "empty": [], "one": before[:1], "wrong": [{**before[0], "steps": 5}, {}]}[states]
    with pytest.raises(ValueError, match="state"):
        pair.set_state(given)
    assert same(pair.get_state(), before)


@pytest.mark.parametrize("actions", ["abc", None, [["a"] * 44] * 2, [[1j] * 44] * 2, [[1], [2, 3]], 3])
def test_actions_of_many_are_arrays_of_numbers(pair, actions):
    pair.reset(seed=0)
    before = pair.get_state()
    with pytest.raises(ValueError, match="expected"):
        pair.step(actions)
    assert same(pair.get_state(), before)


@pytest.mark.parametrize("numbers", [{"num_envs": "a"}, {"num_envs": 1.5}, {"num_envs": 2, "threads": "x"}])
def test_there_is_a_whole_number_of_infants_and_threads(bundle, numbers):
    with pytest.raises(ValueError, match="expected a whole number that is not negative as"):
        mimoc.make_vec(bundle, **numbers)
