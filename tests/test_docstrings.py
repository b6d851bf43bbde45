"""The examples in docstrings give what they say; what users meet first has one."""

import doctest
import importlib
import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from support import store
from support.motions import moved, retargeted

import mimoc
from mimoc.base.errors import SpecError
from mimoc.recording.reading import ReadRecording
from mimoc.schema.infant import InfantSpec
from mimoc.training import Curve

CHECKOUT = Path(__file__).resolve().parents[1]
PACKAGE = Path(mimoc.__file__).parent
STUDY = """\
mimoc: 1
cohort: study
base: nine_months.yaml
children: {draw: 2, seed: 7}
vary: {age_months: [6, 9]}
do: [build]
measure: [length_cm]
"""
KIM = {"mimoc": 1, "name": "kim", "age_months": 9, "senses": {"proprioception": {}}, "scene": {"kind": "flat"}}
BESIDES = (InfantSpec.with_, SpecError, ReadRecording, Curve)
"""What users meet besides the names of `mimoc` itself; the docstring of a spec's class is help on its keys."""


def examples() -> Iterator[doctest.DocTest]:
    finder = doctest.DocTestFinder(exclude_empty=True)
    for path in sorted(PACKAGE.rglob("*.py")):
        if ">>> import" in path.read_text(encoding="utf-8"):
            name = ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
            yield from (test for test in finder.find(importlib.import_module(name), globs={}) if test.examples)


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Return a folder as a user has it: specs, a bundle, a study, a recording, a trained policy, a filmed infant."""
    folder = tmp_path_factory.mktemp("user")
    for name in ("nine_months", "reach"):
        shutil.copy(CHECKOUT / "configs" / f"{name}.yaml", folder)
    (folder / "study.yaml").write_text(STUDY)
    mimoc.write_bundle(store.built(CHECKOUT / "configs" / "nine_months.yaml"), folder / "out/nine_months")
    with mimoc.Recorder(mimoc.make(folder / "reach.yaml"), folder / "recordings/reach") as env:
        env.reset(seed=0)
        for _ in range(3):
            env.step(env.action_space.sample())
    short = {"n_steps": 64, "batch_size": 64}
    mimoc.train(folder / "reach.yaml", folder / "runs/reach", steps=64, envs=1, processes=False, hyper=short)
    kim = store.built(KIM)
    child = retargeted(kim, moved(kim, seconds=0.33))
    mimoc.write_points(child.recording, folder / "filmed.npz")
    mimoc.write_retargeted(child, folder / "retargeted/kim")
    return folder


@pytest.mark.parametrize("example", list(examples()), ids=lambda example: example.name)
def test_an_example_gives_what_it_says(example, folder, monkeypatch):
    monkeypatch.chdir(folder)
    said: list[str] = []
    runner = doctest.DocTestRunner(optionflags=doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)
    assert runner.run(example, out=said.append).failed == 0, "".join(said)


ELSEWHERE = ("__version__", "InfantSpec", "InfantEnv")
"""Names whose examples are those of `InfantSpec.with_` and `make`."""
FIRST_MET = [getattr(mimoc, name) for name in mimoc.__all__ if name not in ELSEWHERE]


@pytest.mark.parametrize("thing", [*FIRST_MET, *BESIDES], ids=lambda thing: thing.__qualname__)
def test_what_users_meet_first_has_an_example(thing):
    assert ">>> " in thing.__doc__
