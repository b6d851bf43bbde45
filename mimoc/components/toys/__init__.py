"""Sources of toys, each in its own module or folder."""
