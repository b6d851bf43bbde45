"""Two antagonistic muscles for each joint."""
