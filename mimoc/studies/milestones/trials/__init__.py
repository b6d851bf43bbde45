"""The trials: what infants learn to do, each as an experiment in physics."""

from collections.abc import Mapping

from mimoc.studies.milestones.trial import Trial
from mimoc.studies.milestones.trials.hands_and_knees import ARM_OUT, HANDS_AND_KNEES, LEG_LIFT, ROCKING
from mimoc.studies.milestones.trials.head import HEAD_LAG, PRONE_HEAD, ROLL_OVER, SUPINE_HEAD
from mimoc.studies.milestones.trials.standing import HALF_SQUAT, PULL_TO_STAND, SITTING, STANDING

MILESTONES: tuple[Trial, ...] = (PRONE_HEAD, HALF_SQUAT, ARM_OUT, HEAD_LAG, SITTING, HANDS_AND_KNEES, STANDING)
FURTHER: tuple[Trial, ...] = (LEG_LIFT, ROLL_OVER, SUPINE_HEAD, ROCKING, PULL_TO_STAND)
"""Those that are only reported, until they are understood."""
TRIALS: Mapping[str, Trial] = {trial.name: trial for trial in (*MILESTONES, *FURTHER)}


def trial_called(name: str) -> tuple[Trial, str]:
    """Return the trial and the side of a name such as `sit` or `arm_out:left`; no side is either."""
    trial, _, side = name.partition(":")
    return TRIALS[trial], side
