"""A room drawn at random."""
