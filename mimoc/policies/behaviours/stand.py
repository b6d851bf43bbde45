"""Standing alone."""

from mimoc.policies.behaviours.behaviour import Option, Subject, read_arguments
from mimoc.policies.behaviours.posture import Posture
from mimoc.policies.control.holding.postures import FEET, fallen, stance

OPTIONS = {"knees_deg": Option(0.0, -90.0, 0.0), "lean": Option(0.3, 0.0, 1.0)}
"""Angle of the knees, and where the centre of mass stands: 0 over the ankles, 1 over the toes."""


def bind(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that stands as in the trial `stand`."""
    infant, numbers = subject.infant, read_arguments("stand", text, OPTIONS).numbers
    subject.require("stand", *FEET, *(foot.replace("foot", "toes") for foot in FEET))
    forbidden, start = infant.parts_without(FEET), stance(infant, numbers["knees_deg"], numbers["lean"])
    return Posture(subject, start, lambda data, others: fallen(infant, data, forbidden - others))
