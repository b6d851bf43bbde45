import gc
import os
import subprocess
import sys
import threading
import types
import weakref
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from support.full import full_rows

import mimoc
from mimoc.base.errors import RenderingError
from mimoc.render import opengl
from mimoc.render.renderer import Renderer

ADVICE = "install EGL or OSMesa"


class Library:
    """Stands for one of MuJoCo's OpenGL modules, which works or fails in one of the ways seen in the wild."""

    def __init__(self, fault):
        self.fault = fault

    def load(self, name):
        """Import it; PyOpenGL is left behind as it is when a library cannot be loaded."""
        backend = name.removeprefix("mujoco.")
        if backend in ("egl", "osmesa"):
            assert os.environ.setdefault("PYOPENGL_PLATFORM", backend) == backend
            assert sys.modules.setdefault("OpenGL.fake", types.ModuleType(backend)).__name__ == backend
        if self.fault == "import":
            raise AttributeError("'NoneType' object has no attribute 'eglQueryString'")
        return self

    def GLContext(self, width, height):  # noqa: N802 - MuJoCo's name.
        if self.fault == "context":
            raise RuntimeError("no device")
        self.size = width, height
        return self

    def make_current(self):
        if self.fault == "current":
            raise RuntimeError("cannot be made current")

    def get_current_context(self):
        return self.fault != "no screen"


@pytest.fixture
def tried(monkeypatch):
    """Return which libraries are tried, among working ones; `tried.faults` says which do not work."""
    log = type("Log", (list,), {})()
    log.faults = {}
    for variable in ("MUJOCO_GL", "DISPLAY", "WAYLAND_DISPLAY", "PYOPENGL_PLATFORM"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr(sys, "modules", {name: m for name, m in sys.modules.items() if not name.startswith("OpenGL")})
    monkeypatch.setattr(sys, "platform", "linux")

    def load(name):
        backend = name.removeprefix("mujoco.")
        if name.startswith("mujoco."):
            log.append(backend)
        return Library(log.faults.get(backend)).load(name)

    monkeypatch.setattr(opengl.importlib, "import_module", load)
    return log


def test_egl_is_used_where_there_is_no_screen(tried):
    assert opengl.open_context(30, 20).size == (30, 20)
    assert tried == ["egl"]


@pytest.mark.parametrize("variable", ["DISPLAY", "WAYLAND_DISPLAY"])
def test_a_screen_is_used_where_there_is_one(tried, variable, monkeypatch):
    monkeypatch.setenv(variable, ":0")
    opengl.open_context(30, 20)
    assert tried == ["glfw"]


@pytest.mark.parametrize(("platform", "library"), [("darwin", "cgl"), ("win32", "glfw")])
def test_each_system_has_its_library(tried, platform, library, monkeypatch):
    monkeypatch.setattr(sys, "platform", platform)
    opengl.open_context(30, 20)
    assert tried == [library]


@pytest.mark.parametrize("wish", ["egl", "osmesa", "glfw", " OSMesa "])
def test_a_wish_is_honoured(tried, wish, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", wish)
    monkeypatch.setenv("DISPLAY", ":0")
    opengl.open_context(30, 20)
    assert tried == [wish.strip().lower()]


@pytest.mark.parametrize("fault", ["import", "context", "current"])
def test_the_next_library_is_tried_as_if_the_first_had_never_been(tried, fault):
    tried.faults["egl"] = fault
    opengl.open_context(30, 20)
    assert tried == ["egl", "osmesa"]
    assert os.environ["PYOPENGL_PLATFORM"] == "osmesa"


def test_a_screen_that_does_not_answer_is_passed_over(tried, monkeypatch):
    """GLFW does not fail then; MuJoCo would, with an error that ends the process."""
    monkeypatch.setenv("DISPLAY", ":99")
    tried.faults["glfw"] = "no screen"
    opengl.open_context(30, 20)
    assert tried == ["glfw", "egl"]


def test_without_any_library_it_says_so_in_one_line(tried):
    tried.faults.update(egl="import", osmesa="context")
    with pytest.raises(RenderingError, match=rf"egl: AttributeError, osmesa: RuntimeError\); {ADVICE}") as refusal:
        opengl.open_context(30, 20)
    assert "\n" not in str(refusal.value)
    assert tried == ["egl", "osmesa"]


def test_no_other_library_is_tried_than_the_one_that_is_wished(tried, monkeypatch):
    monkeypatch.setenv("MUJOCO_GL", "osmesa")
    tried.faults["osmesa"] = "import"
    with pytest.raises(RenderingError, match=rf"\(osmesa: AttributeError\); {ADVICE}"):
        opengl.open_context(30, 20)


DRAW = """
import os, sys
{first}
import mimoc
{then}
env = mimoc.InfantEnv(sys.argv[1], render_mode="rgb_array", width=32, height=24)
env.model.vis.quality.shadowsize = 0
env.reset()
print(env.render().shape)
{last}
"""


@pytest.mark.full
@pytest.mark.parametrize(
    ("first", "then", "last"),
    full_rows(
        [
            ("", "", ""),
            ("import mujoco, OpenGL", "", ""),
            ("import weakref; weakref.finalize(os, print).detach()", "", "env.close()"),
        ],
        [
            ("", "", "env.close()"),
            ("import mujoco", "", ""),
            ("", "os.environ.pop('MUJOCO_GL', None)", ""),
            ("import weakref; weakref.finalize(os, print).detach()", "", ""),
        ],
    ),
    ids=[
        "mimoc first",
        "PyOpenGL first",
        "another finalizer first, closed",
        "mimoc first, closed",
        "MuJoCo first",
        "no wish after the import",
        "another finalizer first",
    ],
)
def test_it_draws_whatever_was_imported_before_and_ends_quietly(first, then, last, folder):
    """Also if the environment is left open, which is then closed at the exit."""
    code = DRAW.format(first=first, then=then, last=last)
    done = subprocess.run([sys.executable, "-c", code, folder], capture_output=True, text=True, check=False)
    assert (done.returncode, done.stdout, done.stderr) == (0, "(24, 32, 3)\n", "")


def test_what_is_drawn_with_is_freed_once_and_not_kept_for_the_exit(monkeypatch):
    freed, registered = [], []
    hooks = types.SimpleNamespace(register=registered.append, unregister=registered.remove)
    monkeypatch.setattr(opengl, "atexit", hooks)
    owners = [Library(None) for _ in range(3)]
    called, detached, dropped = (opengl.Finalizer(owner, freed.append, None) for owner in owners)
    assert registered == [called, detached, dropped]
    called()
    assert freed == [None]
    assert detached.detach()[0] is owners[1]
    owners.clear()
    assert freed == [None, None]
    assert registered == []
    assert not dropped.alive


@pytest.mark.parametrize(
    ("platform", "display", "expected"),
    [("linux", None, False), ("linux", ":0", True), ("win32", None, True), ("darwin", None, True)],
)
def test_there_is_a_screen_where_windows_and_browsers_can_show_something(platform, display, expected, monkeypatch):
    monkeypatch.setattr("sys.platform", platform)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.delenv("DISPLAY", raising=False)
    if display:
        monkeypatch.setenv("DISPLAY", display)
    assert opengl.has_screen() == expected


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
