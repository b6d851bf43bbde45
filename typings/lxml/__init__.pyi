"""lxml is compiled and comes without types."""
