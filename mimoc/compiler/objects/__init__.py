"""What all kinds of objects share when a world is built."""
