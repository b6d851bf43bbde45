"""Experiments of the paper and others: each is the `EXPERIMENT` of a module, which is imported when it is needed."""

from collections.abc import Mapping

_NAMES = (
    *("growth", "strength", "acuity", "delays", "inverse", "rooms", "development", "growing"),
    *("kicking", "weights", "mobile", "contingency", "stepping", "looking", "localisation", "regard"),
)
EXPERIMENTS: Mapping[str, str] = {name: f"mimoc.studies.experiments.{name}" for name in _NAMES}  # Modules by name.
GROUP = "mimoc.experiments"  # Entry points of plug-ins, each named as the `Experiment` that it leads to.
