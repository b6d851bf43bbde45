"""Pictures: OpenGL, cameras, portraits, windows and plots."""
