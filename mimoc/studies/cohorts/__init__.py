"""Cohorts: many infants, what is done with each, and one table of all."""

from mimoc.studies.cohorts.cohort import Cohort, Failure, Status, read_cohort  # noqa: F401
from mimoc.studies.cohorts.job import Job  # noqa: F401
from mimoc.studies.cohorts.run_jobs import JobContext  # noqa: F401
