"""Wooden blocks."""

from mimoc.schema.kinds import ToySource
from mimoc_nursery.blocks.spec import BlocksSpec

KIND = ToySource(
    name="blocks",
    about="Wooden blocks: a cube, a slab and a column.",
    build="mimoc_nursery.blocks.build",
    spec=BlocksSpec,
)
