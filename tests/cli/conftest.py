"""Where commands are tried, and an infant to try them on."""

from pathlib import Path

import pytest

import mimoc

CONFIGS = Path(__file__).parents[2] / "configs"


@pytest.fixture(scope="session")
def built(tmp_path_factory) -> Path:
    """Return the folder of a bundle, which is only to be read."""
    compiled = mimoc.build(mimoc.load_spec(CONFIGS / "nine_months.yaml"))
    return mimoc.write_bundle(compiled, tmp_path_factory.mktemp("bundles") / "nine_months")


@pytest.fixture
def here(tmp_path, monkeypatch) -> Path:
    """Return an empty folder that is the working directory."""
    monkeypatch.chdir(tmp_path)
    return tmp_path
