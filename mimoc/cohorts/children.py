"""Children drawn from WHO's growth standards: length, weight and head jointly."""

from statistics import NormalDist

import numpy as np

from mimoc.random_streams import stream
from mimoc.rounding import rounded
from mimoc.schema.body import IndividualSpec
from mimoc.schema.cohort_file import DrawnChildren
from mimoc.schema.quantities import LARGEST_PERCENTILE, LEAST_PERCENTILE

PERCENTILES = ("length_percentile", "weight_percentile", "head_percentile")

LENGTH_WEIGHT = 0.74
"""Correlation of the z-scores of length and weight.

Derived for mimoc (D) from WHO's own standards: log BMI is log weight minus twice log length, so that their coefficients
of variation give r = (S_weight^2 + 4 S_length^2 - S_bmi^2) / (4 S_weight S_length). At 24 months, where S_bmi is .07771
for boys and .08545 for girls (last day of WHO's tables of BMI for age from birth to two years, read in a copy), that is
.75 and .74. Its change with age is left out.
"""
LENGTH_HEAD, WEIGHT_HEAD = 0.45, 0.5
"""Correlations of the z-score of head circumference with those of length and weight: an assumption (M), not a source's.

Geraedts et al. 2011 (Horm Res Paediatr 75:213-219; 14,500 Dutch children) find that the head correlates with both, most
at birth and, after a rapid decline, at a stable level. Only their abstract was at hand, which gives no numbers.
"""
CORRELATIONS = np.array(
    [[1, LENGTH_WEIGHT, LENGTH_HEAD], [LENGTH_WEIGHT, 1, WEIGHT_HEAD], [LENGTH_HEAD, WEIGHT_HEAD, 1]]
)
"""Correlations of the z-scores of length, weight and head, shape (3, 3)."""

_FURTHEST = 1e-9
"""Smallest probability of a tail that is drawn from, so that no draw is infinite."""


def draw_children(wanted: DrawnChildren) -> tuple[IndividualSpec, ...]:
    """Return children whose percentiles are those of WHO's healthy children, and stay the same as they age.

    Each child has random numbers of its own: the first children of a seed are the same however many are drawn.
    """
    mixing, normal = np.linalg.cholesky(CORRELATIONS), NormalDist()
    sexes = ("female", "male") if wanted.sex == "both" else (wanted.sex,)
    children = []
    for index in range(wanted.draw):
        shares = stream(wanted.seed, f"cohort.child.{index}").random(len(PERCENTILES))
        z = mixing @ [normal.inv_cdf(min(max(float(share), _FURTHEST), 1 - _FURTHEST)) for share in shares]
        probabilities = (normal.cdf(float(each)) for each in z)
        percentiles = {
            name: rounded(min(max(100 * probability, LEAST_PERCENTILE), LARGEST_PERCENTILE))
            for name, probability in zip(PERCENTILES, probabilities, strict=True)
        }
        children.append(IndividualSpec(sex=sexes[index % len(sexes)], **percentiles))
    return tuple(children)
