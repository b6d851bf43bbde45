"""Balance."""

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from mimoc.schema.base import Model, omitting
from mimoc.schema.entries import Sensor
from mimoc.schema.kinds import AGES_MONTHS, AgeTable, NoiseOption, SenseKind
from mimoc.schema.quantities import Distinct

if TYPE_CHECKING:
    from mimoc.body.tree import BodyTree
    from mimoc.compiler.mjcf.scene import Placed


VestibularQuantity = Literal["accelerometer", "gyro"]
Canals = Literal["off", "age", "adult", "afferent"]
Seconds = Annotated[float, Field(ge=0, le=1000, allow_inf_nan=False)]


class VestibularSpec(Model):
    """The vestibular sense: linear and angular motion of the head."""

    include: Annotated[tuple[VestibularQuantity, ...], *Distinct, Field(min_length=1)] = ("accelerometer", "gyro")
    """Measured quantities: specific force (`accelerometer`, the otoliths), angular velocity (`gyro`, the semicircular
    canals), or both."""
    canals: Canals | None = None
    """Rotation that is felt: as fast as the head turns (`off`, the default), with slow rotations lost as at the
    infant's age (`age`) or in adults (`adult`), or what the nerve alone says of it (`afferent`)."""


class CanalsEntry(Model):
    """Dynamics of the semicircular canals: what is felt of a rotation over time."""

    time_constant_s: Annotated[Seconds, Field(gt=0)]
    """Within which a constant rotation is no longer felt."""
    adaptation_s: Annotated[Seconds, Field(gt=0)]
    """Time constant of adaptation."""
    lead_s: Seconds = 0.0
    """Time constant by which fast changes are felt more; 0 is none."""
    lag_s: Seconds = 0.0
    """Time constant up to which they are; 0 is none."""

    @model_validator(mode="after")
    def _is_a_filter(self) -> Self:
        poles_s = [self.time_constant_s, self.adaptation_s, *([self.lag_s] if self.lag_s else [])]
        if len(set(poles_s)) < len(poles_s) or (self.lead_s and not self.lag_s):
            raise ValueError("time constants must differ, and a lead needs a lag")
        return self


class VestibularEntry(Model):
    """The vestibular sense."""

    kind: Literal["vestibular"] = "vestibular"
    """Name of the sense."""
    accelerometer: Sensor | None = None
    """Sensor of the head's specific force, [m/s²], if it is measured."""
    gyro: Sensor | None = None
    """Sensor of the head's angular velocity, [rad/s], if it is measured."""
    canals: CanalsEntry | None = None
    """Dynamics of the canals; None where rotation is felt as it is."""

    _serialized = omitting("canals")


WHOLE_S: Mapping[float, float] = {0: 4.0, 2: 6.0, 6: 10.0, 24: 15.0}
"""Time constant of felt rotation by months. Derived (D): nystagmus after a step lasts 10 s at birth and 15 s at two
months (Weissman et al. 1989), and adults' time constants are 15 to 25 s, as the brain stores velocity."""
CUPULA_S, ADAPTATION_S = 5.7, 80.0
"""Time constants of the cupula and of adaptation of humans (Rader, Oman & Merfeld 2009)."""
LEAD_S, LAG_S = 0.049, 0.003
"""Lead and lag of the squirrel monkey's canal nerve (Fernández & Goldberg 1971; from memory, M)."""
RULES = {
    "age": "derived (D): 4 s at birth, 6 at 2 months, 10 at 6, 15 from 24, interpolated; nystagmus of newborns "
    "(Weissman et al. 1989), velocity storage of adults",
    "adult": "derived (D): least time constant of adults with velocity storage, 15 to 25 s",
    "afferent": "cupula of humans (Rader, Oman & Merfeld 2009); lead and lag of the squirrel monkey's nerve "
    "(Fernández & Goldberg 1971, from memory)",
}
"""What the time constants go by."""


def build(spec: VestibularSpec, body: "BodyTree") -> "Placed":
    """Return the entry; every body has the sensors, whether it has the sense or not."""
    from mimoc.compiler.mjcf.scene import Placed
    from mimoc.compiler.mjcf.sensor_sites import VESTIBULAR_SENSORS

    names = {sensor.kind: sensor.name for sensor in VESTIBULAR_SENSORS if sensor.kind in spec.include}
    canals = _canals(spec.canals, body.age_months) if "gyro" in spec.include else None
    entry = VestibularEntry(accelerometer=names.get("accelerometer"), gyro=names.get("gyro"), canals=canals)
    return Placed(entry, origins=dict(_origins(str(spec.canals), canals)) if canals else {})


def _canals(canals: str | None, age_months: float) -> CanalsEntry | None:
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


KIND = SenseKind(
    name="vestibular",
    spec=VestibularSpec,
    entry=VestibularEntry,
    build=build,
    run="mimoc.components.senses.vestibular.run",
    physiological_delay=AgeTable(AGES_MONTHS, (10, 10, 10, 10, 10, 10)),
    noise=NoiseOption(
        unit="thresholds",
        about="Standard deviation of felt rotation and acceleration, in thresholds of adults (1 deg/s, .03 m/s²), or "
        "that of the infant's age (`age`) or of adults (`adult`).",
        most=1000.0,
        run="mimoc.components.senses.vestibular.run:bind_noise",
        by_age=((0.0, 1.0), (24.0, 0.5)),
        adult=0.5,
        source="half the threshold in adults, twice as much in newborns: a guess, as no infant was measured (D)",
        omit_if_absent=True,
    ),
)
