"""Motor milestones: from which age on an infant can do what real infants learn to do."""

from mimoc.milestones.infant import Conditions, Infant, compile_at
from mimoc.milestones.report import Milestone, MilestoneReport, validate_milestones
from mimoc.milestones.trial import Outcome, Trial, try_out
from mimoc.milestones.trials import FURTHER, MILESTONES, TRIALS
from mimoc.milestones.windows import WINDOWS, Window

__all__ = [
    "FURTHER",
    "MILESTONES",
    "TRIALS",
    "WINDOWS",
    "Conditions",
    "Infant",
    "Milestone",
    "MilestoneReport",
    "Outcome",
    "Trial",
    "Window",
    "compile_at",
    "try_out",
    "validate_milestones",
]
