"""The vestibular sense on a body."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf import sensor_sites
from mimoc.compiler.mjcf.scene import Placed
from mimoc.components.senses.vestibular import CanalsEntry, VestibularEntry, VestibularSpec

WHOLE_S: Mapping[float, float] = {0: 4.0, 2: 6.0, 6: 10.0, 24: 15.0}
"""Time constant of felt rotation by months. Derived (D): nystagmus after a step lasts 10 s at birth and 15 s at two
months (Weissman et al. 1989), and adults' time constants are 15 to 25 s, as the brain stores velocity."""
CUPULA_S, ADAPTATION_S = 5.7, 80.0
"""Time constants of the cupula and of adaptation of humans (Rader, Oman & Merfeld 2009)."""
LEAD_S, LAG_S = 0.049, 0.003  # Of the squirrel monkey's canal nerve (Fernández & Goldberg 1971; from memory, M).
RULES = {
    "age": "derived (D): 4 s at birth, 6 at 2 months, 10 at 6, 15 from 24, interpolated; nystagmus of newborns "
    "(Weissman et al. 1989), velocity storage of adults",
    "adult": "derived (D): least time constant of adults with velocity storage, 15 to 25 s",
    "afferent": "cupula of humans (Rader, Oman & Merfeld 2009); lead and lag of the squirrel monkey's nerve "
    "(Fernández & Goldberg 1971, from memory)",
}
"""What the time constants go by."""


def build(spec: VestibularSpec, body: BodyTree) -> Placed:
    """Return the entry; every body has the sensors, whether it has the sense or not."""
    names = {sensor.kind: sensor.name for sensor in sensor_sites.VESTIBULAR_SENSORS if sensor.kind in spec.include}
    canals = _canals(spec.canals, body.age_months) if "gyro" in spec.include else None
    entry = VestibularEntry(accelerometer=names.get("accelerometer"), gyro=names.get("gyro"), canals=canals)
    return Placed(entry, origins=dict(_origins(str(spec.canals), canals)) if canals else {})


def _canals(canals: str | None, age_months: float) -> CanalsEntry | None:
    """Return the dynamics of the canals, if rotation is not felt as it is."""
    if canals is None or canals == "off":
        return None
    if canals == "afferent":
        return CanalsEntry(time_constant_s=CUPULA_S, adaptation_s=ADAPTATION_S, lead_s=LEAD_S, lag_s=LAG_S)
    months = age_months if canals == "age" else max(WHOLE_S)
    whole_s = float(np.interp(months, list(WHOLE_S), list(WHOLE_S.values())))
    return CanalsEntry(time_constant_s=whole_s, adaptation_s=ADAPTATION_S)


def _origins(canals: str, entry: CanalsEntry) -> Iterator[tuple[str, dict[str, Any]]]:
    sources = ["spec.senses.vestibular.canals", *(["spec.age_months"] if canals == "age" else [])]
    rules = dict.fromkeys(CanalsEntry.model_fields, RULES[canals]) | {
        "adaptation_s": "adaptation of humans (Rader, Oman & Merfeld 2009)"
    }
    for name, rule in rules.items():
        value = getattr(entry, name)
        if value:
            yield f"vestibular.canals.{name}", {"value": value, "unit": "s", "rule": rule, "from": sources}
