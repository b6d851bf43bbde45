"""How floors, walls, ceilings and pictures are drawn."""
