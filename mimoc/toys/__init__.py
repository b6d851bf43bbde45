"""Toys: what they look like, what they touch with, what they weigh; and where they come from, a folder each."""

from mimoc.kinds import Kinds, ToySource

TOY_SOURCES: Kinds[ToySource] = Kinds(
    "source of toys",
    {
        "builtin": "mimoc.toys.builtin",
        "toys4k": "mimoc.toys.toys4k",
    },
)
