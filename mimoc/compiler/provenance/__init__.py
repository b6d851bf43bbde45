"""Where each number of a bundle comes from."""
