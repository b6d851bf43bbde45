"""What docs/own_sense.md prints runs as it is printed: on one infant, on many, and on a device."""

import importlib
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import mimoc
from mimoc.schema.components.senses import SENSES
from mimoc.schema.composition import recompose

CHECKOUT = Path(__file__).resolve().parents[3]
PAGE = "docs/own_sense.md"


@pytest.fixture
def session(tmp_path, monkeypatch):
    """Run all programs of the page in one session; the whole plug-in is a file."""
    programs = re.findall(r"^```python\n(.*?)^```$", (CHECKOUT / PAGE).read_text(), re.MULTILINE | re.DOTALL)
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
