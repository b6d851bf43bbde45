"""What all actuation models share when an infant is built."""
