import inspect
import os
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
from support.bad_specs import SPECS

import mimoc
from mimoc.base import errors, lazy
from mimoc.base.errors import (
    MimocError,
    MissingExtraError,
    ModelError,
    Problem,
    SpecError,
    UnknownNameError,
    suggestion,
)
from mimoc.schema import read_spec
from mimoc.schema.source import read

LIMBS = ["left_hand", "left_foot", "right_hand", "right_foot"]


def test_a_problem_says_where_what_and_what_to_do():
    problem = Problem("specs/a.yaml", 3, 7, "body.hands", "'miten' is not a choice; did you mean 'mitten'?")
    assert str(problem) == "specs/a.yaml:3:7: body.hands: 'miten' is not a choice; did you mean 'mitten'?"
    assert str(Problem("a.yaml", 1, 1, "", "the file is empty")) == "a.yaml:1:1: the file is empty"
    assert str(UnknownNameError("limb", "tail", ["arm"])) == "'tail' is not a limb; choose from arm"


def test_problems_come_once_each_in_the_order_of_the_file():
    problems = [Problem("a.yaml", line, 1, "k", "wrong") for line in (10, 9, 10, 2)]
    assert [problem.line for problem in SpecError(problems).problems] == [2, 9, 10]
    assert str(SpecError(problems)).count("\n") == 2


@pytest.mark.parametrize(
    ("name", "advice"),
    [
        ("left_hnd", "did you mean 'left_hand'?"),
        ("left_hoot", "did you mean 'left_foot'?"),
        ("tail", "choose from left_foot, left_hand, right_foot, right_hand"),
    ],
)
def test_the_nearest_name_is_suggested_and_else_all_are_listed(name, advice):
    assert suggestion(name, LIMBS).startswith(advice.removesuffix("?"))


def test_a_long_list_is_cut_short_and_says_so():
    advice = suggestion("zzz", [f"toy_{index:03}" for index in range(500)])
    assert advice.endswith("toy_039, ... (500 in all)")


def test_a_missing_extra_says_what_to_run():
    assert str(MissingExtraError("matplotlib", "report")).endswith("pip install 'mimoc[report]'")


def test_a_model_error_knows_its_element():
    assert ModelError("refused", "head").element == "head"
    assert ModelError("refused").element is None


def test_every_error_is_a_mimoc_error_and_says_why_it_exists():
    for _, kind in inspect.getmembers(errors, inspect.isclass):
        if issubclass(kind, Exception):
            assert issubclass(kind, MimocError)
            assert kind.__doc__


def test_an_opengl_that_mujoco_cannot_load_is_explained_in_python_too(monkeypatch):
    """Its import fails with whatever PyOpenGL raises where its library is missing."""
    failing = "raise AttributeError(\"'NoneType' object has no attribute 'eglQueryString'\")"
    monkeypatch.setattr(lazy, "import_module", lambda name: exec(failing, {"__name__": "mujoco"}))
    monkeypatch.setenv("MUJOCO_GL", "egl")
    with pytest.raises(AttributeError, match="eglQueryString"):  # MuJoCo is there, so that something else is wrong.
        mimoc.InfantSpec  # noqa: B018
    monkeypatch.delitem(sys.modules, "mujoco")
    with pytest.raises(MimocError, match=r"with MUJOCO_GL=egl \(.*\); unset it, choose egl or osmesa, or install"):
        mimoc.InfantSpec  # noqa: B018


@pytest.mark.parametrize("case", SPECS)
def test_bad_specs_get_these_texts(case, snapshot, tmp_path, monkeypatch):
    content = SPECS[case]
    monkeypatch.chdir(tmp_path)
    Path("spec.yaml").write_bytes(content if isinstance(content, bytes) else content.encode())
    with pytest.raises(SpecError) as refusal:
        read_spec(read("spec.yaml"))
    readable = isinstance(content, str) and "\x1b" not in content
    shown = content if readable else f"{content[:60]!r}\n"
    assert f"{shown}\n{refusal.value}" == snapshot


FILES: dict[str, Callable[[Path], object]] = {
    "a missing file": lambda path: None,
    "a folder": lambda path: path.mkdir(),
    "100 MB of YAML": lambda path: (path.touch(), os.truncate(path, 100_000_000)),
    "a pipe": os.mkfifo,
    "a link to itself": lambda path: path.symlink_to(path),
}


@pytest.mark.parametrize("case", FILES)
def test_what_is_no_spec_file_gets_these_texts(case, snapshot, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    FILES[case](tmp_path / "spec.yaml")
    with pytest.raises(SpecError) as refusal:
        read("spec.yaml")
    assert str(refusal.value) == snapshot
