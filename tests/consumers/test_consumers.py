"""Libraries of others read default bundles; `make consumers` runs those that are too large to install here."""

from importlib import import_module
from pathlib import Path

import pytest
from consumers.prepare import prepare

SMALL = ("attach", "rollout", "checkers", "minari_data_set", "mink_reaching", "skrl_training")
PROGRAMS = {path.stem for path in Path(__file__).parent.glob("*.py")} - {"prepare", "use", "test_consumers"}


@pytest.fixture(scope="module")
def bundles(tmp_path_factory) -> Path:
    return prepare(tmp_path_factory.mktemp("consumers"))


@pytest.mark.parametrize("name", SMALL)
def test_a_consumer_takes_default_bundles(bundles, name, monkeypatch):
    monkeypatch.setenv("MINARI_DATASETS_PATH", "")  # Which one of them sets.
    assert import_module(f"consumers.{name}").use(bundles)
