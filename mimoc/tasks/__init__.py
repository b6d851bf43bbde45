"""What an infant is to achieve."""
