"""Cohorts: many infants, what is done with each, and one table of all."""

from mimoc.cohorts.cohort import Cohort, Failure, Status, read_cohort
from mimoc.cohorts.job import Job
from mimoc.cohorts.work import JobContext

__all__ = ["Cohort", "Failure", "Job", "Status", "JobContext", "read_cohort"]
