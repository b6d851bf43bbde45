"""Pain, by region of the body."""

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np
from pydantic import Field

from mimoc.schema.base import Model
from mimoc.schema.entries import Amount, Body, Duration, Hinge, Label
from mimoc.schema.kinds import AGES_MONTHS, AgeTable, SenseKind
from mimoc.schema.quantities import Degrees, Distinct, Real

if TYPE_CHECKING:
    from mimoc.body.tree import BodyTree
    from mimoc.compiler.mjcf.scene import Placed


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


WITHDRAWAL_MN: Mapping[float, float] = {0: 12.0, 3: 20.0, 6: 30.0, 12: 45.0}
"""Force of a von Frey hair on the sole at which the leg is withdrawn, by months: 12 mN at three days and 45 at 12
months are medians (Kühne et al. 2012), those between are derived (D)."""
HAIR_MM2, HAIR_MN = 0.045, 12.0
"""Area of the tip of the hair that bends at a force (from memory, M); that of others is as the root of their force,
since hairs of one length bend at a force like the fourth power of their diameter (Euler)."""
OTHER_SKIN = 3.0
"""Threshold of skin that is not of hands, feet or head, relative to the sole's, as that at the knee is (Andrews &
Fitzgerald 1994: higher towards the knee; the factor is derived, D). Hands and head are assumed to be as the sole is."""
DECAY_MS = 1000.0
"""Time constant within which pain fades, as the reflex to a heel lance lasts 1 to 2 s (from memory, M)."""
KPA_CM2_IN_N = 0.1


def build(spec: PainSpec, body: "BodyTree") -> "Placed":
    """Return the entry; nothing stands for pain in the MJCF."""
    from mimoc.body.tree import region_of_bodies
    from mimoc.compiler.mjcf.scene import Placed

    kpa = threshold_kpa(body.age_months if spec.threshold == "age" else max(WITHDRAWAL_MN))
    region_of = region_of_bodies(body)
    members = dict[str, list[Any]]()
    for part in body.bodies:
        members.setdefault(region_of[part.name], []).append(part)
    regions = tuple(
        PainRegion(
            name=name,
            bodies=tuple(part.name for part in parts),
            joints=tuple(joint.name for part in parts if part.group != "eyes" for joint in part.joints),
            threshold_n=kpa * spec.area_cm2 * KPA_CM2_IN_N * (1.0 if _is_tender(name) else OTHER_SKIN),
        )
        for name, parts in members.items()
    )
    entry = PainEntry(regions=regions, strain_deg=spec.strain_deg, decay_ms=DECAY_MS)
    return Placed(entry, origins=_origins(spec, entry))


def threshold_kpa(age_months: float) -> float:
    """Return the pressure of a hair on the sole at which the leg is withdrawn, in [kPa]."""
    force_mn = float(np.interp(age_months, list(WITHDRAWAL_MN), list(WITHDRAWAL_MN.values())))
    return force_mn / (HAIR_MM2 * math.sqrt(force_mn / HAIR_MN))


def _is_tender(region: str) -> bool:
    from mimoc.body.tree import PALMS_AND_SOLES

    return region == "head" or region in PALMS_AND_SOLES


def _origins(spec: PainSpec, entry: PainEntry) -> dict[str, dict[str, Any]]:
    rule = (
        "withdrawal of the leg from von Frey hairs on the sole: 12 mN at 3 days, 45 at 12 months (Kühne et al. 2012), "
        "20 and 30 at 3 and 6 (D), over the area of their tips (M); x the area on which a contact presses (assumed)"
    )
    sources = ["spec.senses.pain.threshold", "spec.senses.pain.area_cm2"]
    sources += ["spec.age_months"] if spec.threshold == "age" else []
    origins = {
        f"pain.{region.name}.threshold": {
            "value": region.threshold_n,
            "unit": "N",
            "rule": rule if _is_tender(region.name) else f"{rule}; x {OTHER_SKIN:g}, as at the knee (D)",
            "from": sources,
        }
        for region in entry.regions
    }
    decay = {"value": entry.decay_ms, "unit": "ms", "rule": "reflex to a heel lance (M)", "from": []}
    return {**origins, "pain.decay_ms": decay}


KIND = SenseKind(
    name="pain",
    spec=PainSpec,
    entry=PainEntry,
    build=build,
    run="mimoc.components.senses.pain.run",
    physiological_delay=AgeTable(AGES_MONTHS, (250, 240, 220, 190, 150, 100)),
    omit_if_absent=True,
)
