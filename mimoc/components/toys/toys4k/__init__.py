"""The toys of the Toys4K data set, or other meshes in a folder."""
