"""Nine faces: the spec's is the first, and it can be changed while the infant lives."""

from itertools import combinations

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import UnknownNameError
from mimoc.runtime.expression import expression_of
from mimoc.schema.expressions import EXPRESSIONS

LEAST_DIFFERENCE = 15
"""So many pixels of a picture of 240 by 240 differ at least: it shows."""


def open_env(expression: str | None = None, size: int = 240, **body) -> mimoc.InfantEnv:
    body |= {} if expression is None else {"expression": expression}
    spec = {"mimoc": 1, "name": "x", "age_months": 9, "body": body, "scene": {"kind": "flat", "pose": "sitting"}}
    bundle = mimoc.build(mimoc.InfantSpec.model_validate(spec))
    env = mimoc.InfantEnv(bundle, render_mode="rgb_array", width=size, height=size)
    env.model.vis.quality.shadowsize = 0  # Shadows take time to draw.
    env.reset(seed=0)
    return env


@pytest.fixture(scope="module")
def env():
    env = open_env()
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
        assert changed_pixels(pictures[one], pictures[other]) > LEAST_DIFFERENCE, (one, other)


def test_changing_back_and_forth_gives_the_same_picture(env):
    first = picture(env, "neutral")
    assert changed_pixels(first, picture(env, "happy"))
    assert np.array_equal(picture(env, "neutral"), first)


@pytest.mark.parametrize("expression", EXPRESSIONS)
def test_the_specs_expression_is_the_one_it_starts_with(env, expression):
    started = open_env(expression)
    assert np.array_equal(started.render(), picture(env, expression))
    started.close()


@pytest.mark.parametrize("skin", [True, False])
def test_the_face_is_known_with_a_skin_and_without(skin):
    env = open_env("sad", 16, skin=skin)
    assert expression_of(env.manifest, env.model) == "sad"
    env.set_expression("happy")
    assert expression_of(env.manifest, env.model) == "happy"
    env.close()


def test_it_starts_neutral_if_the_spec_says_nothing(env):
    started = open_env()
    assert np.array_equal(started.render(), picture(env, "neutral"))
    started.close()


def test_it_can_be_changed_while_running_and_moves_nothing():
    """Also through Gymnasium's wrappers, by `env.unwrapped`."""
    serious, moody = open_env(), open_env()
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
    env = open_env("happy")
    env.set_expression("angry")
    angry = env.render()
    env.reset(seed=0)
    assert np.array_equal(env.render(), angry)
    env.close()
