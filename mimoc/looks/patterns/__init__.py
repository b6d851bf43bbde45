"""Drawing of textures for floors, walls, ceilings and pictures."""
