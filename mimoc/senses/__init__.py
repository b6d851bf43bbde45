"""What an infant perceives."""
