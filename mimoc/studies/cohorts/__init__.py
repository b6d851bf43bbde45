"""Cohorts: many infants, what is done with each, and one table of all."""
