"""Toys: shapes, collision geoms, mass, choice and placement; each source of toys is a module or a folder."""

from mimoc.base.kinds import Kinds
from mimoc.schema.kinds import ToySource

TOY_SOURCES: Kinds[ToySource] = Kinds(
    "source of toys",
    {
        "builtin": ToySource("builtin", "The toys that come with mimoc.", "mimoc.components.toys.builtin"),
        "toys4k": ToySource(
            "toys4k",
            "The toys of the Toys4K data set, or other meshes in a folder.",
            "mimoc.components.toys.toys4k.build",
            needs_root=True,
        ),
    },
)
