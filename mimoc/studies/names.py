"""Which experiments there are: light, as the command line's help lists them."""

from collections.abc import Mapping

_NAMES = (
    *("growth", "strength", "acuity", "delays", "inverse", "rooms", "development", "growing"),
    *("kicking", "weights", "mobile", "contingency", "stepping", "looking", "localisation", "regard"),
)
EXPERIMENTS: Mapping[str, str] = {name: f"mimoc.studies.experiments.{name}" for name in _NAMES}
"""Module of each experiment, imported when needed; its `run` takes a notebook and returns the path of the report."""
