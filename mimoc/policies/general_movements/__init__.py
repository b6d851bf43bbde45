"""Infants that move by themselves: general movements, kicks, and movements towards goals, by age."""
