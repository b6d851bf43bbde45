"""The compiler: from a spec to a bundle."""
