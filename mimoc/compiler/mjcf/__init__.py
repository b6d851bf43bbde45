"""What is printed as MJCF, as values, and the printing."""
