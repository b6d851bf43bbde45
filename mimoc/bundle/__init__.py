"""The bundle: the files that the compiler writes and the runtime reads."""
