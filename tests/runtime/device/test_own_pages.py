"""What docs/own_sense.md and docs/own_actuation.md print runs as it is printed: on one infant, on many, on a device."""

import importlib
import re
import sys
from pathlib import Path

import numpy as np
import pytest
from support.devices import DEVICE

import mimoc
from mimoc.schema.base import recompose
from mimoc.schema.kinds import ACTUATIONS, SENSES

CHECKOUT = Path(__file__).resolve().parents[3]


def programs_of(page: str) -> list[str]:
    text = (CHECKOUT / "docs" / page).read_text(encoding="utf-8")
    return re.findall(r"^```python\n(.*?)^```$", text, re.MULTILINE | re.DOTALL)


@pytest.fixture
def session(tmp_path, monkeypatch):
    """Run all programs of the page in one session; the whole plug-in is a file."""
    programs = programs_of("own_sense.md")
    (plugin,) = (program for program in programs if "KIND = SenseKind(" in program)
    (tmp_path / "upright.py").write_text(plugin)
    (tmp_path / "configs").symlink_to(CHECKOUT / "configs")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    importlib.invalidate_caches()
    names = {}
    for program in programs:
        if program is not plugin:
            exec(program, names)
    yield names
    SENSES.remove("upright")
    recompose()
    del sys.modules["upright"]


def test_it_runs_as_printed_and_gives_the_same_everywhere(session):
    one = session["env"]
    many, device = (mimoc.make_vec(session["infants"], 4, **options) for options in ({}, {"device": "warp:cpu"}))
    one.reset(seed=0), many.reset(seed=0), device.reset(seed=0)
    generator = np.random.default_rng(0)
    for _ in range(5):
        actions = generator.uniform(-1.0, 1.0, many.action_space.shape).astype(np.float32)
        alone, together, close = one.step(actions[0])[0], many.step(actions)[0], device.step(actions)[0]
        assert alone["upright"].tobytes() == together["upright"][0].tobytes()
        assert close["upright"] == pytest.approx(together["upright"], abs=1e-5)
    assert np.unique(together["upright"], axis=0).shape == (4, 4)
    many.close(), device.close()


@pytest.fixture
def forgotten():
    yield
    ACTUATIONS.remove("dead_zone")
    recompose()


def test_the_programs_of_the_page_on_actuation_do_what_they_say(forgotten, capsys):
    session: dict[str, object] = {}
    for program in programs_of("own_actuation.md"):
        exec(program.replace("warp:cpu", DEVICE), session)
    printed = [float(line) for line in capsys.readouterr().out.splitlines() if re.fullmatch(r"[0-9.]+", line)]
    assert printed == pytest.approx([0.5, 0.5])
