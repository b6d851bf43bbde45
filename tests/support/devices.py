"""The device that the tests of MuJoCo Warp run on: its CPU, or a GPU if `MIMOC_TEST_DEVICE` says so."""

import os
from collections.abc import Mapping
from typing import Any

import numpy as np

DEVICE = os.environ.get("MIMOC_TEST_DEVICE", "warp:cpu")  # As `mimoc.make_vec` takes it.
WARP_DEVICE = DEVICE.removeprefix("warp:")  # The same, as Warp calls it.
CLOSE = 1e-4  # Difference of angles [rad] that is left between MuJoCo and MuJoCo Warp after some steps.


def assert_close(
    ours: Mapping[str, Any], theirs: Mapping[str, Any], infant: Any, limit: float = CLOSE, others: float = 30 * CLOSE
) -> None:
    """Compare observations: angles in [rad]; other quantities relatively, if they are large, by another limit."""
    for name, values in theirs.items():
        errors = np.abs(ours[name] - values) / np.maximum(1.0, np.abs(values))
        layout = infant.layout(name) if name == "proprioception" else ()
        angles = [index for index, number in enumerate(layout) if number.endswith("[rad]")]
        assert errors[:, angles].max(initial=0.0) < limit, name
        assert errors.max() < max(others, 30 * limit), name
