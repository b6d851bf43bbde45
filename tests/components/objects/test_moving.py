"""Objects are moved by a reset, stay where they are as the infant grows, and are part of a state."""

import copy
import pickle
from contextlib import closing

import numpy as np
import pytest
from support.scenes_of_objects import TOUCH_M, deepest_m, spec_with

import mimoc
from mimoc.base.errors import UnknownNameError

OBJECTS = (
    {"name": "ball", "radius_cm": 4, "at": "within reach of right_hand"},
    {"name": "block", "shape": "box", "motion": "fixed", "at": {"x_cm": 60, "y_cm": 0}},
    {"name": "bead", "radius_cm": 2, "above": "chest", "height_cm": 25},
    {"name": "car", "toy": "car", "motion": "sliding", "at": {"x_cm": 60, "y_cm": 30}},
    {
        "name": "mobile",
        "kind": "mobile",
        "figures": ["ball", "ball"],
        "above": "head",
        "height_cm": 45,
        "tied_to": "left_foot",
    },
)
SPEC = {
    **spec_with(*OBJECTS),
    "actuation": {"model": "torque"},
    "senses": {"proprioception": {}, "touch": {"density": 0.3}},
}
ELSEWHERE = {
    "ball": "within reach of left_hand",
    "block": {"x_cm": 40, "y_cm": 40, "yaw_deg": 45},
    "bead": {"x_cm": -60, "y_cm": 0, "z_cm": 30},
    "car": {"x_cm": 70, "y_cm": -30},
    "mobile": {"x_cm": 0, "y_cm": 20, "z_cm": 60},
}


@pytest.fixture(scope="module")
def env():
    with closing(mimoc.make(mimoc.InfantSpec.model_validate(SPEC))) as made:
        yield made


def places(env) -> dict[str, list[float]]:
    """Return where the outermost body of each object is."""
    infant = env.unwrapped
    return {item.name: infant.data.body(item.body).xpos.round(6).tolist() for item in infant.manifest.objects}


def steps(env, count: int = 3):
    actions = np.random.default_rng(0).uniform(-1, 1, (count, *env.action_space.shape)).astype(np.float32)
    return [env.step(action)[0] for action in actions]


def test_a_reset_puts_objects_elsewhere_for_one_episode(env):
    env.reset(seed=0)
    built = places(env)
    env.reset(options={"objects": ELSEWHERE})
    moved, infant = places(env), env.unwrapped
    for name in ELSEWHERE:
        assert np.linalg.norm(np.subtract(moved[name], built[name])) > 0.05, name
    np.testing.assert_allclose(moved["block"], (0.4, 0.4, 0.03), atol=1e-6)
    assert infant.data.geom("object_bead").xpos[2] == pytest.approx(0.32)
    assert deepest_m(infant.bundle, infant.model, infant.data) < TOUCH_M
    hand_m = infant.data.body("left_hand").xpos
    assert np.linalg.norm(np.subtract(moved["ball"], hand_m)) < 0.2
    env.reset()
    assert places(env) == built


def test_a_moved_mobile_is_tied_again(env):
    infant = env.unwrapped
    for options in ({}, {"objects": ELSEWHERE}):
        env.reset(options=options)
        ribbon = infant.model.tendon("object_mobile_ribbon").id
        assert infant.model.tendon_range[ribbon, 1] - infant.data.ten_length[ribbon] == pytest.approx(0.005, abs=1e-6)


def test_moved_objects_are_part_of_a_state_of_a_copy_and_of_a_pickle(env):
    env.reset(seed=1, options={"objects": ELSEWHERE})
    state, moved = env.unwrapped.get_state(), places(env)
    seen = steps(env)
    for other in (copy.deepcopy(env), pickle.loads(pickle.dumps(env)), env):
        other.reset(seed=2)
        assert places(other)["block"] != moved["block"]
        other.unwrapped.set_state(state)
        assert places(other) == moved
        for mine, theirs in zip(seen, steps(other), strict=True):
            assert all(np.array_equal(mine[name], theirs[name]) for name in mine)


def test_growing_leaves_them_where_they_are(env):
    env.reset(seed=0)
    built = places(env)
    for options in ({}, {"objects": ELSEWHERE}):
        env.reset(seed=0, options={"age_months": 6, **options})
        before = places(env)
        env.unwrapped.grow(9)
        np.testing.assert_allclose([*places(env).values()], [*before.values()], atol=2e-3)
    env.reset(options={"age_months": 9})
    assert places(env)["bead"][2] > built["bead"][2]
    env.reset(options={"age_months": 6})
    assert places(env) == built


@pytest.mark.parametrize(
    ("moves", "error", "message"),
    [
        ({"ball": {"x_cm": 0, "y_cm": 0}}, ValueError, "object 'ball' would be inside of '"),
        ({"block": {"x_cm": 60, "y_cm": 30}}, ValueError, "object 'block' would be inside of 'object_car'"),
        (
            {"bal": {"x_cm": 0, "y_cm": 0}},
            UnknownNameError,
            "'bal' is not a named object of this scene; did you mean 'ball'",
        ),
        ({"ball": "somewhere"}, ValueError, "'somewhere' is not a place; write 'within reach of NAME'"),
        (
            {"ball": "beside chest"},
            ValueError,
            "object 'ball': it cannot be moved to 'beside chest'; write 'within reach",
        ),
        ({"ball": {"x_cm": "far", "y_cm": 0}}, ValueError, "object 'ball': x_cm: "),
        ({"ball": 7}, ValueError, "object 'ball': 7 is not a place; give {'x_cm': 20"),
        ({"ball": "on car"}, ValueError, "object 'ball': there is no object 'car' with a level top to lie on"),
        ({"ball": "within reach of left_foot"}, ValueError, "object 'ball': 'left_foot' is no hand of this infant"),
        ([1, 2], ValueError, "expected a dictionary of places by the name of the object"),
    ],
)
def test_wrong_places_are_refused_and_change_nothing(env, moves, error, message):
    env.reset(seed=3)
    state, before = env.unwrapped.get_state(), places(env)
    with pytest.raises(error) as refusal:
        env.reset(options={"objects": moves})
    assert message in str(refusal.value)
    assert places(env) == before
    np.testing.assert_array_equal(env.unwrapped.get_state()["physics"], state["physics"])


def test_without_objects_there_is_no_such_option():
    with closing(mimoc.make(mimoc.InfantSpec.model_validate(spec_with()))) as env:
        with pytest.raises(UnknownNameError, match="'objects' is not a reset option"):
            env.reset(options={"objects": {}})
        assert not any(field.size == 0 for field in env.unwrapped.get_state()["model"][1:])


def test_each_infant_of_a_batch_has_its_own_places_and_is_as_a_single_one():
    spec = mimoc.InfantSpec.model_validate(SPEC)
    moves = [ELSEWHERE, {"ball": {"x_cm": 60, "y_cm": 60}}]
    actions = np.random.default_rng(1).uniform(-1, 1, (4, 2, *mimoc.make(spec).action_space.shape)).astype(np.float32)
    with closing(mimoc.make_vec(spec, num_envs=2)) as batch:
        seen = [batch.reset(seed=5, options={"objects": moves})[0], *(batch.step(action)[0] for action in actions)]
    for index, move in enumerate(moves):
        with closing(mimoc.make(spec)) as env:
            single = [env.reset(seed=5 + index, options={"objects": move})[0]]
            single += [env.step(action[index])[0] for action in actions]
        for ours, theirs in zip(seen, single, strict=True):
            assert all(np.array_equal(ours[name][index], theirs[name]) for name in theirs)
