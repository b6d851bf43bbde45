"""The window follows the environment, no faster than real time; MuJoCo's viewer itself is played by a stand-in."""

from contextlib import nullcontext
from types import SimpleNamespace

import glfw
import mujoco.viewer
import numpy as np
import pytest

import mimoc
from mimoc.base.errors import RenderingError
from mimoc.render import environment


class Viewer:
    """What `mujoco.viewer.launch_passive` returns, as far as it is used."""

    def __init__(self, data):
        self.data, self.shown_s, self.open = data, [], True
        self.cam = SimpleNamespace(lookat=np.zeros(3), azimuth=0.0, elevation=0.0, distance=0.0)

    def lock(self):
        return nullcontext()

    def is_running(self):
        return self.open

    def sync(self):
        self.shown_s.append(self.data.time)

    def close(self):
        self.open = False


@pytest.fixture
def screen(monkeypatch):
    seen = SimpleNamespace(viewers=[], now_s=100.0, slept_s=[])

    def launch(model, data, **options):
        seen.viewers.append(Viewer(data))
        return seen.viewers[-1]

    def sleep(time_s):
        seen.slept_s.append(time_s)
        seen.now_s += time_s

    monkeypatch.setenv("DISPLAY", ":7")
    monkeypatch.setattr(glfw, "init", lambda: True)
    monkeypatch.setattr(mujoco.viewer, "launch_passive", launch)
    monkeypatch.setattr(environment, "time", SimpleNamespace(sleep=sleep, monotonic=lambda: seen.now_s))
    return seen


def test_the_reset_and_every_step_are_shown_in_real_time(bundle, screen):
    env = mimoc.make(bundle, render_mode="human")
    env.reset(seed=0)
    for _ in range(3):
        env.step(env.action_space.sample())
        assert env.render() is None
    assert screen.viewers[0].shown_s == pytest.approx([0, 0.01, 0.02, 0.03])
    assert screen.now_s == pytest.approx(100.03)
    env.close()
    assert not screen.viewers[0].open


def test_a_simulation_that_is_late_does_not_catch_up(bundle, screen):
    env = mimoc.InfantEnv(bundle, render_mode="human")
    env.reset(seed=0)
    screen.now_s += 5
    for _ in range(3):
        env.step(env.action_space.sample())
    assert screen.slept_s == pytest.approx([0, 0, 0.01, 0.01], abs=1e-9)
    env.close()


def test_a_reset_starts_the_clock_anew(bundle, screen):
    env = mimoc.InfantEnv(bundle, render_mode="human")
    env.reset(seed=0)
    for _ in range(3):
        env.step(env.action_space.sample())
    env.reset()
    env.step(env.action_space.sample())
    assert screen.slept_s[-2:] == pytest.approx([0, 0.01], abs=1e-9)
    env.close()


def test_the_infant_is_in_the_middle_of_the_window(bundle, screen):
    env = mimoc.InfantEnv(bundle, render_mode="human")
    assert screen.viewers[0].cam.lookat == pytest.approx(env.data.body("hip").xpos)
    env.close()


def test_a_window_that_the_user_closes_stays_closed(bundle, screen):
    env = mimoc.InfantEnv(bundle, render_mode="human")
    env.reset(seed=0)
    screen.viewers[0].close()
    env.step(env.action_space.sample())
    assert screen.viewers[0].shown_s == [0]
    env.close()
    env.close()


def test_windows_are_offered_where_there_is_a_screen(bundle, monkeypatch):
    for display, modes in [("", ["rgb_array"]), (":7", ["human", "rgb_array"])]:
        monkeypatch.setenv("DISPLAY", display)
        monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
        assert mimoc.InfantEnv(bundle).metadata["render_modes"] == modes


def test_without_a_screen_there_is_one_clear_error(bundle, monkeypatch):
    monkeypatch.setattr(glfw, "init", lambda: False)
    with pytest.raises(RenderingError, match="there is no screen here; use render_mode='rgb_array'"):
        mimoc.make(bundle, render_mode="human")
