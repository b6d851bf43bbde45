"""Where commands are tried, and an infant to try them on."""

from pathlib import Path

import pytest

import mimoc

CONFIGS = Path(__file__).parents[2] / "configs"


@pytest.fixture(scope="session")
def built(tmp_path_factory) -> Path:
    compiled = mimoc.build(mimoc.load_spec(CONFIGS / "nine_months.yaml"))
    return mimoc.write_bundle(compiled, tmp_path_factory.mktemp("bundles") / "nine_months")


@pytest.fixture(scope="session")
def one_age(tmp_path_factory) -> Path:
    """Return a spec that says how long its child is: `validate` takes it at its own age only, and little time."""
    file = tmp_path_factory.mktemp("specs") / "one_age.yaml"
    file.write_text("mimoc: 1\nname: measured\nage_months: 9\nbody: {individual: {length_cm: 71}}\n")
    return file


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    monkeypatch.chdir(tmp_path)
    return tmp_path
