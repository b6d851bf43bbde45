"""A place for a bundle."""

from pathlib import Path

import pytest


@pytest.fixture
def out(tmp_path) -> Path:
    (tmp_path / "builds").mkdir()
    return tmp_path / "builds" / "infant"
