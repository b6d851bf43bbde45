"""Lying on the belly, on the forearms, with the head up."""

from mimoc.policies.behaviours.behaviour import Subject, read_arguments
from mimoc.policies.behaviours.posture import Posture
from mimoc.policies.control.holding.postures import SIDES, drooped, on_forearms


def bind(subject: Subject, text: str = "") -> Posture:
    """Return the behaviour that lies on the forearms with the head up, as in the trial `prone_head`."""
    infant = subject.infant
    read_arguments("prone", text, {})
    subject.require("prone", "head", *(f"{side}_{part}" for side in SIDES for part in ("lower_arm", "upper_leg")))
    return Posture(subject, on_forearms(infant), lambda data, others: drooped(infant, data))
