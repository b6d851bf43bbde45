"""Toys: shapes, collision geoms, mass, choice and placement; each source of toys is a folder."""

from mimoc.kinds import Kinds, ToySource

TOY_SOURCES: Kinds[ToySource] = Kinds(
    "source of toys",
    {
        "builtin": "mimoc.toys.builtin",
        "toys4k": "mimoc.toys.toys4k",
    },
)
