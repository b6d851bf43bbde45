"""Sitting without support."""

from collections.abc import Iterator

from mimoc.policies.control.holding.postures import SEAT, seat, slumped
from mimoc.studies.milestones.infant import TrialInfant
from mimoc.studies.milestones.trial import PUSHES, Attempt, Trial

SITTING_S = 10.0
KNEES_DEG = (-60.0, -40.0, -20.0)  # Knees of the postures that are tried.
LEANS = (0.3, 0.4)
"""Where the centre of mass stands in the postures that are tried: 0 over the seat, 1 over the heels.

Chosen while looking at the ages. Upright, closer to the seat, a trunk balances without strength, so that even a
month-old infant sits; that takes control without noise and delay. Further forward, the trunk has to be strong.
"""


def _sitting(infant: TrialInfant) -> Iterator[Attempt]:
    forbidden = infant.parts_without(SEAT[1:]) - {infant.model.body("hip").id}
    for knee_deg in KNEES_DEG:
        for lean in LEANS:
            yield Attempt(
                infant,
                seat(infant, knee_deg, lean),
                SITTING_S,
                lambda data: slumped(infant, data, forbidden),
                pushes=PUSHES,
                strategy=f"knees {knee_deg:g}°, weight {lean:g} of the way from seat to heels",
            )


SITTING = Trial("sit", "sits without support for 10 s", _sitting, ("left_foot", "right_foot"), "fitted")
