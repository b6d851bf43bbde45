"""A filmed infant on its own body: a fit of sizes and of all frames at once, and the folder that keeps it."""
