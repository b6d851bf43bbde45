"""The smooth skin of an infant: a sculpted mesh that is carried to each child by its solids."""
