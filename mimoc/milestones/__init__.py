"""Motor milestones: from which age on an infant can do what real infants learn to do."""

from mimoc.milestones.infant import Conditions, TrialInfant, compile_at
from mimoc.milestones.report import Milestone, MilestoneReport, validate_milestones
from mimoc.milestones.trial import Outcome, Trial, try_out
from mimoc.milestones.trials import FURTHER, MILESTONES, TRIALS
from mimoc.milestones.windows import WINDOWS, AgeRange

__all__ = [
    "FURTHER",
    "MILESTONES",
    "TRIALS",
    "WINDOWS",
    "AgeRange",
    "Conditions",
    "Milestone",
    "MilestoneReport",
    "Outcome",
    "Trial",
    "TrialInfant",
    "compile_at",
    "try_out",
    "validate_milestones",
]
