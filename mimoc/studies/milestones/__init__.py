"""Motor milestones: from which age on an infant can do what real infants learn to do."""

from mimoc.studies.milestones.infant import Conditions, TrialInfant, compile_at
from mimoc.studies.milestones.report import WINDOWS, AgeRange, Milestone, MilestoneReport, validate_milestones
from mimoc.studies.milestones.search import search_near
from mimoc.studies.milestones.trial import Outcome, Trial, try_out
from mimoc.studies.milestones.trials import FURTHER, MILESTONES, TRIALS

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
    "search_near",
    "try_out",
    "validate_milestones",
]
