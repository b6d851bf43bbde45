"""WHO's growth curves and where a child is on them, for a page."""

from collections.abc import Sequence
from statistics import NormalDist
from typing import Any

import numpy as np

from mimoc import fits
from mimoc.bundle.manifest import ChildEntry
from mimoc.fits.who import percentile
from mimoc.viewer.packing import Packed

INDICATORS = ("length_cm", "weight_kg", "head_circumference_cm")
PERCENTILES = (3.0, 15.0, 50.0, 85.0, 97.0)
"""Those that WHO's own charts show."""
CURVE_AGES_MONTHS = tuple(half / 2 for half in range(49))
"""Ages of the points of the curves."""


def describe_standards(packed: Packed, children: Sequence[ChildEntry]) -> dict[str, Any]:
    """Return WHO's percentiles by age for children of this sex, and the child's own measures at its ages.

    Args:
        packed: Where the arrays go.
        children: The child at each age.
    """
    reference = children[0].sex or "mean"
    tables = fits.load_tables().who
    z_scores = [NormalDist().inv_cdf(share / 100) for share in PERCENTILES]
    found = {}
    for name in INDICATORS:
        curves = [[tables[name].value(z, age, reference) for z in z_scores] for age in CURVE_AGES_MONTHS]
        values = [getattr(child, name) for child in children]
        z_of = [
            tables[name].z_score(value, child.age_months, reference)
            for value, child in zip(values, children, strict=True)
        ]
        found[name] = {
            "curves": packed.put(np.array(curves)),
            "child": packed.put(np.array(values)),
            "percentile": packed.put(np.array([percentile(z) for z in z_of])),
        }
    return {"reference": reference, "percentiles": PERCENTILES, "ages_months": CURVE_AGES_MONTHS, "measures": found}
