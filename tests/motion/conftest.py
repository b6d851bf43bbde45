"""Infants that are filmed."""

import pytest
from support import filmed

from mimoc.motion.point_recording import PointRecording


@pytest.fixture(scope="session")
def kicking() -> PointRecording:
    """Return two seconds of a kicking infant, from above, without depth."""
    return filmed.filmed()


@pytest.fixture(scope="session")
def body_25() -> PointRecording:
    return filmed.filmed(names=filmed.BODY_25_POINTS)


@pytest.fixture(scope="session")
def in_space() -> PointRecording:
    return filmed.in_space()
