"""A caregiver: a simple adult by the infant, who acts by a script, answers what the infant does, or does as told."""
