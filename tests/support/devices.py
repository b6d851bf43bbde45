"""The device that the tests of MuJoCo Warp run on: its CPU, or a GPU if `MIMOC_TEST_DEVICE` says so."""

import os

DEVICE = os.environ.get("MIMOC_TEST_DEVICE", "warp:cpu")
"""As `mimoc.make_vec` takes it."""
WARP_DEVICE = DEVICE.removeprefix("warp:")
"""The same, as Warp calls it."""
