"""Thousands of infants on a GPU: their physics, senses, delays, tasks and resets on MuJoCo Warp."""

from importlib.util import find_spec

from mimoc.base.errors import MissingExtraError

if find_spec("warp") is None or find_spec("mujoco_warp") is None:
    raise MissingExtraError("MuJoCo Warp", "gpu")
