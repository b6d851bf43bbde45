"""The trials."""
