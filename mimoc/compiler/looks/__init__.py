"""Appearance: textures of faces, clothes and rooms."""
