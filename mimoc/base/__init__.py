"""What all other folders stand on: errors, units, kinds, rounding, random streams."""
