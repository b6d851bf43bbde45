"""Plots, drawn with matplotlib."""

from mimoc.render.plots.growth import check_plot_name, draw_growth, plot_growth

__all__ = ["check_plot_name", "draw_growth", "plot_growth"]
