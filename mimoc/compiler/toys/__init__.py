"""Choice, shapes, mass and placement of toys."""
