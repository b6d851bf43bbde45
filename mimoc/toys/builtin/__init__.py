"""The toys that come with mimoc."""

from mimoc.kinds import ToySource

KIND = ToySource(
    name="builtin",
    about="The toys that come with mimoc.",
    build="mimoc.toys.builtin.build",
)
