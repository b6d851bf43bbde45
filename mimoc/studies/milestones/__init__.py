"""Motor milestones: from which age on an infant can do what real infants learn to do."""

from mimoc.studies.milestones.infant import Conditions, TrialInfant, compile_at  # noqa: F401
from mimoc.studies.milestones.report import WINDOWS, AgeRange, Milestone, MilestoneReport, validate_milestones  # noqa: F401
from mimoc.studies.milestones.search import search_near  # noqa: F401
from mimoc.studies.milestones.trial import Outcome, Trial, try_out  # noqa: F401
from mimoc.studies.milestones.trials import FURTHER, MILESTONES, TRIALS  # noqa: F401
