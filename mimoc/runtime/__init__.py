"""The runtime: from a bundle to a Gymnasium environment."""
