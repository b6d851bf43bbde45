"""A process can draw and learn, in both orders; with torch builds for CUDA, each brings an LLVM of its own."""

import ctypes
import os
import subprocess
import sys
import types
from collections.abc import Callable
from pathlib import Path

import pytest
from support.full import full_but

from mimoc.render import opengl
from mimoc.render.opengl import isolate_triton

SEE = """
import sys, mimoc
env = mimoc.make(sys.argv[1])
env.reset(seed=0)
"""
LEARN = """
import torch
weights = torch.nn.Linear(2, 2)
learner = torch.optim.Adam(weights.parameters())
weights(torch.ones(2)).sum().backward()
learner.step()
"""


@pytest.fixture
def python(folder_with_eyes) -> Callable[..., subprocess.CompletedProcess]:
    """Return what runs a program, with an infant that sees and some folders before all others to import from."""

    def run(code: str, *path: Path) -> subprocess.CompletedProcess:
        command = [sys.executable, "-c", code, folder_with_eyes]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, path))}
        return subprocess.run(command, env=environment, capture_output=True, text=True, check=False)

    return run


@pytest.fixture
def triton(tmp_path) -> Path:
    """Return the library of something called triton, in `tmp_path`, which fails if it is imported."""
    library = tmp_path / "triton" / "_C" / "libtriton.so"
    library.parent.mkdir(parents=True)
    (tmp_path / "triton" / "__init__.py").write_text("raise SystemExit('imported')")
    return library


@pytest.mark.parametrize("steps", full_but([(SEE, LEARN)], [(LEARN, SEE)]), ids=["eyes first", "torch first"])
def test_a_process_can_see_and_learn_and_ends_quietly(steps, python):
    """It died when the first optimizer was made, or told at its end that EGL was gone."""
    done = python("".join(steps) + "env.step(env.action_space.sample())\nlearner.step()")
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


@pytest.fixture
def loaded(monkeypatch, tmp_path) -> list:
    """Return what is loaded from now on, and how, on a Linux that finds things in `tmp_path` first."""
    calls = []
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.setattr(os, "RTLD_DEEPBIND", 8, raising=False)
    monkeypatch.setattr(sys, "modules", {name: m for name, m in sys.modules.items() if "triton" not in name})
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(ctypes, "CDLL", lambda *call: calls.append(call))
    return calls


def test_tritons_library_is_loaded_by_itself_and_looks_at_itself_first(triton, loaded):
    triton.touch()
    isolate_triton()
    assert loaded == [(str(triton), os.RTLD_LAZY | os.RTLD_LOCAL | os.RTLD_DEEPBIND)]
    assert "triton" not in sys.modules


def test_a_triton_that_is_in_use_is_left_alone(triton, loaded):
    triton.touch()
    sys.modules["triton._C.libtriton"] = types.ModuleType("libtriton")
    isolate_triton()
    assert loaded == []


def test_other_systems_keep_libraries_apart_themselves(triton, loaded, monkeypatch):
    triton.touch()
    monkeypatch.setattr(sys, "platform", "darwin")
    isolate_triton()
    assert loaded == []


def test_it_is_loaded_before_opengl_is(monkeypatch):
    order = []
    monkeypatch.setattr(opengl, "isolate_triton", lambda: order.append("triton"))
    monkeypatch.setattr(opengl, "_open", lambda *_: order.append("OpenGL"))
    opengl.open_context(8, 8)
    assert order == ["triton", "OpenGL"]


@pytest.mark.parametrize("content", full_but([b"no library"], [b"", None]), ids=["broken", "empty", "missing"])
def test_a_triton_that_cannot_be_loaded_is_no_hindrance_to_drawing(python, triton, tmp_path, content):
    if content is not None:
        triton.write_bytes(content)
    done = python(SEE, tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_something_else_called_triton_is_no_hindrance_either(python):
    done = python("import sys, types; sys.modules['triton'] = types.ModuleType('triton')" + SEE)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
