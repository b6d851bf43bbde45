"""The child in a recording of points, and the motion of its joints: a fit of a body to all frames at once."""
