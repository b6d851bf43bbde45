"""Many infants at once."""
