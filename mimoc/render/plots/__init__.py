"""Plots: values that pages and files of pictures show."""
