"""The world around an infant."""
