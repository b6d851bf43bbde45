"""The ages from which on an infant reaches motor milestones, by the names of the trials that it is tried in."""

from collections.abc import Mapping

from mimoc.base.quantities.quantity import Quantity

_LABELS = {
    "prone_head": "Head kept up while prone",
    "half_squat": "Half squat kept",
    "arm_out": "Arm held out",
    "no_head_lag": "No head lag",
    "sit": "Sitting",
    "hands_and_knees": "Keeping on hands and knees",
    "pull_to_stand": "Rising to stand, held",
    "stand": "Standing alone",
    "leg_lift": "Legs lifted while supine",
    "roll_over": "Rolling over",
    "supine_head": "Head lifted while supine",
    "rocking": "Rocking on hands and knees",
}

MILESTONE_AGES: Mapping[str, Quantity] = {
    trial: Quantity(
        f"{trial}_months",
        label,
        "months",
        f"age from which on the trial `{trial}` succeeds; none if it does not by 24 months",
        over="milestone",
        steps=("milestones",),
        limits=(0.0, 24.0),
    )
    for trial, label in _LABELS.items()
}
"""By the name of the trial."""
