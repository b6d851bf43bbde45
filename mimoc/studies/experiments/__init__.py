"""Experiments of the paper and others: each is a value of a module, which is imported when it is needed."""

from collections.abc import Mapping

_NAMES = (
    *("growth", "strength", "acuity", "delays", "inverse", "rooms", "development", "growing"),
    *("kicking", "weights", "mobile", "contingency", "stepping", "looking", "localisation", "regard"),
    "sitting",
)
_NAMED = {"mobile": "contingency:MOBILE", "contingency": "contingency:CONTINGENCY"}
EXPERIMENTS: Mapping[str, str] = {  # Where each is, as `module:NAME`.
    name: f"mimoc.studies.experiments.{_NAMED.get(name, f'{name}:EXPERIMENT')}" for name in _NAMES
}
GROUP = "mimoc.experiments"  # Entry points of plug-ins, each named as the `Experiment` that it leads to.
