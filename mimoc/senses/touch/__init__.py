"""Touch."""
