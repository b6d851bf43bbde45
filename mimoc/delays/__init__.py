"""How long signals travel between the body and what controls it."""
