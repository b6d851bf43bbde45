"""The toys that come with mimoc."""

from mimoc.kinds import ToySource

BUILTIN = ToySource(
    name="builtin",
    about="The toys that come with mimoc.",
    build="mimoc.toys.builtin.build",
)
