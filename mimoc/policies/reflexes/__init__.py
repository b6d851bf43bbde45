"""Reflexes of infants: stimuli from the senses, responses as tone, each within its window of ages."""
