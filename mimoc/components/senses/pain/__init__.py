"""Pain, by region of the body."""

from typing import Annotated, Literal

from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.entries import Amount, Body, Duration, Hinge, Label
from mimoc.schema.kinds import AGES_MONTHS, AgeTable, SenseKind
from mimoc.schema.quantities import Degrees, Distinct, Real


class PainSpec(Model):
    """Pain: how far pressure, and strain of joints, exceed their thresholds, by region of the body."""

    threshold: Literal["age", "adult"] = "age"
    """Pressure above which it hurts: that of the infant's age (`age`), or as from 12 months on (`adult`)."""
    area_cm2: Annotated[Real, Field(ge=0.01, le=100, json_schema_extra={"unit": "cm2"})] = 2.0
    """Area of skin on which a contact presses, which makes pressure of its force."""
    strain_deg: Annotated[Degrees, Field(ge=0.1, le=90)] = 5.0
    """Angle by which a joint is forced beyond the end of its range, above which it hurts."""


class PainRegion(Model):
    """A region of the body."""

    name: Label
    """Its name, such as `left_hand`."""
    bodies: Annotated[tuple[Body, ...], *Distinct, Field(min_length=1)]
    """The bodies that are in it, the first of which it begins with."""
    joints: Annotated[tuple[Hinge, ...], *Distinct] = ()
    """The joints of these."""
    threshold_n: Annotated[Amount, Field(gt=0)]
    """Force of a contact above which it hurts, [N]."""


class PainEntry(Model):
    """Pain."""

    kind: Literal["pain"] = "pain"
    """Name of the sense."""
    regions: Annotated[tuple[PainRegion, ...], Field(min_length=1)]
    """The regions, in the order of the observation."""
    strain_deg: Annotated[Amount, Field(gt=0)]
    """Angle of a joint beyond the end of its range above which it hurts."""
    decay_ms: Annotated[Duration, Field(gt=0)]
    """Time constant within which pain fades."""


KIND = SenseKind(
    name="pain",
    spec=PainSpec,
    entry=PainEntry,
    build="mimoc.components.senses.pain.build",
    run="mimoc.components.senses.pain.run",
    physiological_delay=AgeTable(AGES_MONTHS, (250, 240, 220, 190, 150, 100)),
    omit_if_absent=True,
)
