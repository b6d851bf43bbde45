"""The body of a caregiver, built from its section of the spec."""
