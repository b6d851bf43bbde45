"""Movement: whether an infant kicks, swings, lifts, folds, looks, grips and steps as real infants do."""

from mimoc.studies.movement.report import WINDOWS, MovementReport, Row, Window, validate_movement, window_of  # noqa: F401
from mimoc.studies.movement.trial import MovementTrial, Subject  # noqa: F401
from mimoc.studies.movement.trials import TRIALS, USUAL  # noqa: F401
