"""Toys: what they look like, what they touch with, what they weigh."""
