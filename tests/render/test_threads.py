"""Environments that draw, used from several threads, after they were closed, and while others are freed."""

import gc
import threading
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import mimoc
from mimoc.base.errors import RenderingError
from mimoc.render.renderer import Renderer


@pytest.fixture
def seeing(open_env):
    return open_env(senses={"vision": {}}, render_mode="rgb_array")


def test_an_infant_with_eyes_lives_in_any_thread_one_after_another(seeing, open_env):
    """As PyQt, Jupyter and web servers do it."""
    same = open_env(senses={"vision": {}}, render_mode="rgb_array")
    action = np.zeros(seeing.action_space.shape)
    for env in (seeing, same):
        env.reset(seed=0)
    for _ in range(2):
        with ThreadPoolExecutor(1) as thread:
            there, picture = thread.submit(lambda: (seeing.step(action)[0], seeing.render())).result()
        here = same.step(action)[0]
        assert all(np.array_equal(there[eye], here[eye]) for eye in here)
        assert np.array_equal(picture, same.render())
    seeing.close()


def test_two_threads_that_draw_at_once_with_the_same_are_told(seeing):
    """And none of them breaks what the other does."""
    renderer = Renderer(seeing.model, 16, 16)
    drawing, done = threading.Event(), threading.Event()

    def draw():
        with renderer.in_use():
            drawing.set()
            done.wait(60)

    thread = threading.Thread(target=draw)
    thread.start()
    drawing.wait(60)
    with pytest.raises(RenderingError, match="use an environment in one thread at a time"):
        renderer.close()
    done.set()
    thread.join()
    with renderer.in_use():
        renderer.draw()
        assert renderer.read().shape == (16, 16, 3)
    renderer.close()


def test_nothing_is_drawn_with_what_is_closed(seeing):
    renderer = Renderer(seeing.model, 16, 16)
    renderer.close()
    renderer.close()
    with pytest.raises(RenderingError, match="closed; open it again"), renderer.in_use():
        pass
    seeing.close()
    with pytest.raises(RenderingError, match="closed; open it again"):
        seeing.senses["vision"](seeing.data)


@pytest.mark.full
def test_a_picture_is_whole_though_python_frees_another_environment_meanwhile(seeing, monkeypatch):
    """Which makes another OpenGL context current: what was drawn afterwards was lost."""
    seeing.reset(seed=0)
    picture = seeing.render()
    forgotten = mimoc.InfantEnv(seeing.bundle, render_mode="rgb_array")
    forgotten.render()
    forgotten.itself = forgotten  # pyright: ignore[reportAttributeAccessIssue] - Only the garbage collector frees it.
    gone, draw = weakref.ref(forgotten), Renderer.draw
    del forgotten

    def draw_later(*arguments):
        gc.collect()
        draw(*arguments)

    monkeypatch.setattr(Renderer, "draw", draw_later)
    assert np.array_equal(seeing.render(), picture)
    assert gone() is None
