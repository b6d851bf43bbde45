"""The toys of the Toys4K data set."""
