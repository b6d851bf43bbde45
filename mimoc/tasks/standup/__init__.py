"""Standing up at a rail."""
