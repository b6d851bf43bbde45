"""What things look like: faces, clothes, the textures of rooms."""
