"""Recording of videos, and of all that infants do and sense."""
