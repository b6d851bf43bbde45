"""What all kinds of scenes share when a world is built."""
