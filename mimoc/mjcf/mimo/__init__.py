"""What code that was written for MIMo looks for in a model."""
