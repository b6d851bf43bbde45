"""Keeping on hands and knees."""

from mimoc.policies.behaviours.behaviour import Option, Subject, read_arguments
from mimoc.policies.behaviours.posture import Posture
from mimoc.policies.control.holding.postures import SUPPORTS, kneel

OPTIONS = {"elbows_deg": Option(-30.0, -90.0, 0.0), "thighs_deg": Option(20.0, -20.0, 40.0)}
"""Angle of the elbows and forward slant of the thighs."""


def bind(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that keeps on hands and knees as in the trial `hands_and_knees`."""
    infant, numbers = subject.infant, read_arguments("hands_and_knees", text, OPTIONS).numbers
    subject.require("hands_and_knees", *SUPPORTS, *(part.replace("upper", "lower") for part in SUPPORTS[2:]))
    forbidden, start = infant.parts_without(SUPPORTS), kneel(infant, numbers["elbows_deg"], numbers["thighs_deg"])
    return Posture(subject, start, lambda data, others: infant.touching(data, forbidden - others))
