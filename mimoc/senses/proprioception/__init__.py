"""Joint angles and what else is felt of the joints."""
