"""Cohorts: many infants, what is done with each, and one table of all."""

from mimoc.studies.cohorts.cohort import Cohort, Failure, Status, read_cohort
from mimoc.studies.cohorts.job import Job
from mimoc.studies.cohorts.run_jobs import JobContext

__all__ = ["Cohort", "Failure", "Job", "Status", "JobContext", "read_cohort"]
