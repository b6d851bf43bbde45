"""Infants to draw in processes of their own."""

from pathlib import Path

import pytest

import mimoc


@pytest.fixture(scope="session")
def folder(bundle_at, tmp_path_factory) -> Path:
    """Return the folder of the bundle of an infant of nine months, which is only to be read."""
    return mimoc.write_bundle(bundle_at(9), tmp_path_factory.mktemp("bundles") / "infant")


@pytest.fixture(scope="session")
def folder_with_eyes(built, tmp_path_factory) -> Path:
    """Return that of an infant that sees little, which is only to be read."""
    seeing = built(senses={"vision": {"width_px": 16, "height_px": 16}})
    return mimoc.write_bundle(seeing, tmp_path_factory.mktemp("bundles") / "seeing")
