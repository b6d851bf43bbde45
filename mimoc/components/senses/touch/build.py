"""Touch on a body."""

from collections.abc import Mapping

import numpy as np

from mimoc.base.units import cm_to_m
from mimoc.body.skin_regions import PALMS_AND_SOLES, region_of_bodies
from mimoc.body.tree import BodyTree
from mimoc.compiler.mjcf.scene import Placed
from mimoc.components.senses.touch import SkinEntry, TouchEntry, TouchSpec
from mimoc.components.senses.touch.build_skin_points import skin_points

SPACING_RULE = "two-point discrimination there at 18 months (MIMo) / sqrt(density), grown with the body's skin"
GIVEN_RULE = "given by the spec for 18 months, grown with the body's skin"

CHANNELS_KEY = "spec.senses.touch.channels"
CHANNELS_RULE = (
    "derived (D; mimoc/components/senses/touch/adaptation.py) from adults' fingertips (Johansson & Vallbo 1979, "
    "Bolanowski 1988; from memory); no infant was measured"
)


def build(spec: TouchSpec, body: BodyTree) -> Placed:
    """Return the entry, and the skin points of the body as an array; nothing stands for them in the MJCF."""
    given_m = spec.spacing_cm and {part: cm_to_m(apart_cm) for part, apart_cm in spec.spacing_cm.items()}
    skin = skin_points(body, spec.density, spec.regions, given_m)
    parts = tuple(
        SkinEntry(body=name, points=len(points_m), spacing_m=skin.spacing_m[name])
        for name, points_m in skin.points_m.items()
    )
    origins = {
        f"skin.{part.body}.spacing": {
            "value": part.spacing_m,
            "unit": "m",
            "rule": GIVEN_RULE if given_m else SPACING_RULE,
            "from": [f"spec.senses.touch.{_key(part.body, body, given_m)}", "spec.age_months"],
        }
        for part in parts
    }
    points_m = np.concatenate([np.empty((0, 3)), *skin.points_m.values()])
    regions, channels = region_of_bodies(body), spec.channels or ()
    hairless = tuple(part.body for part in parts if "ct" in channels and regions[part.body] in PALMS_AND_SOLES)
    entry = TouchEntry(
        quantity="normal" if channels else spec.quantity,
        response=spec.response,
        skin=parts,
        channels=channels,
        hairless=hairless,
    )
    if channels:
        origins["touch.channels"] = {"value": list(channels), "rule": CHANNELS_RULE, "from": [CHANNELS_KEY]}
    return Placed(entry, arrays={"points_m": points_m}, origins=origins)


def _key(name: str, body: BodyTree, given_m: Mapping[str, float] | None) -> str:
    """Return the key of the section that says how far apart the points of a body are."""
    if not given_m:
        return "density"
    return f"spacing_cm.{next(part for part in body.parts_of(name) if part in given_m)}"
