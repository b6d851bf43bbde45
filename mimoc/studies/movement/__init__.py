"""Movement: whether an infant kicks, swings, lifts, folds, looks, grips and steps as real infants do."""

from mimoc.studies.movement.report import WINDOWS, MovementReport, Row, Window, validate_movement, window_of
from mimoc.studies.movement.trial import MovementTrial, Subject
from mimoc.studies.movement.trials import TRIALS, USUAL

__all__ = [
    "TRIALS",
    "USUAL",
    "WINDOWS",
    "MovementReport",
    "MovementTrial",
    "Row",
    "Subject",
    "Window",
    "validate_movement",
    "window_of",
]
