"""Pictures of numbers."""

from mimoc.plot.growth import draw_growth, plot_growth

__all__ = ["draw_growth", "plot_growth"]
