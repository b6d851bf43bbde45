"""The toys of the Toys4K data set, or other meshes in a folder."""

from mimoc.kinds import ToySource

KIND = ToySource(
    name="toys4k",
    about="The toys of the Toys4K data set, or other meshes in a folder.",
    build="mimoc.toys.toys4k.build",
    needs_root=True,
)
