"""Comparisons of the compiled infant with what is known of children."""
