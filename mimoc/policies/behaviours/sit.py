"""Sitting without support."""

from mimoc.policies.behaviours.behaviour import Option, Subject, read_arguments
from mimoc.policies.behaviours.posture import Posture
from mimoc.policies.control.holding.postures import FEET, SEAT, seat, slumped

OPTIONS = {"knees_deg": Option(-60.0, -90.0, 0.0), "lean": Option(0.3, 0.1, 0.6)}
"""Angle of the knees, and where the centre of mass stands: 0 over the seat, 1 over the heels. The defaults are the
posture in which infants sit youngest."""


def bind(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that sits as in the trial `sit`."""
    infant, numbers = subject.infant, read_arguments("sit", text, OPTIONS).numbers
    subject.require("sit", *SEAT, *FEET)
    forbidden = infant.parts_without(SEAT[1:]) - {infant.body(SEAT[0])}
    start = seat(infant, numbers["knees_deg"], numbers["lean"])
    return Posture(subject, start, lambda data, others: slumped(infant, data, forbidden - others))
