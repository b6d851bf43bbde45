"""The benchmark that others enter: fixed infants, tasks and seeds, and what policies score in them."""
